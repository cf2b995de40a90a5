#include "libcore/check/passive.hpp"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "libcore/base/format.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/base/text.hpp"
#include "libcore/follow/node_force.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

// What energies may be off by, as a part of the forces: they are kept as floats.
constexpr double kRounding = 1e-6;
// What the hand may gain by a snap: what a friction of so many newtons takes along two spacings. No
// closed walk through a one-way link has less than four, since the straight way back leads
// elsewhere; common devices have more friction (Geomagic Touch: 0.26 N).
constexpr double kFriction = 0.2;
constexpr double kAllowedAtSnap = 2 * kFriction;  // in newtons times the spacing
constexpr int kPlaces = 32;                       // of a link, where the model may snap

Check empty_check() {
  return {"passive", "links", "snaps that lead up, so that a closed walk gains energy", {}};
}

/// A link along an axis, at both ends of which a branch ends.
using OneWayLink = BranchNodes::OneWayLink;

bool is_finite_node(const NodeEnergy& node) {
  return std::isfinite(node.energy) && std::isfinite(node.slope[0]) &&
         std::isfinite(node.slope[1]) && std::isfinite(node.slope[2]);
}

/// On the edge from one node to the next one along an axis, at the part u of the way.
double energy_between(const NodeEnergy& from, const NodeEnergy& to, int axis, int sign, double u) {
  NodeCorners corners;
  for (int k = 0; k < 8; ++k) corners[k] = (k >> axis & 1) == (sign > 0) ? &to : &from;
  Vec3 part{0, 0, 0};
  part[axis] = sign > 0 ? u : 1 - u;
  return hermite_energy(corners, part);
}

/// What a snap leads up at the part `at` of the link, in newtons times the spacing.
/// @param allowed is set: what of that is allowed because it is extrapolated
double rise_at(const Grid& grid, const BranchNodes& branches, const NodeEnergies& nodes,
               const OneWayLink& link, double at, double& allowed) {
  const auto step = Direction(link.q).step();
  const int axis = step[0] != 0 ? 0 : step[1] != 0 ? 1 : 2, sign = step[axis];
  const RecordIndex target = grid.destination(link.from, link.q);
  const NodeEnergy &from = nodes[link.from], &to = nodes[target];
  // Where either branch is on the other side; the one behind the snap may be nowhere.
  const NodeEnergy& end = nodes[branches.node(link.from, link.q)];
  const Node start = branches.node(target, Direction(link.q).opposite().q());
  const double up = -energy_between(from, end, axis, sign, at);
  allowed = 0;
  for (int a = 0; a < 3; ++a)
    allowed += kRounding * (std::abs(from.slope[a]) + std::abs(to.slope[a]));
  const auto allow = [&](const NodeEnergy& record, const NodeEnergy& beyond, int way, double part) {
    allowed += std::abs(beyond.energy - record.energy - way * record.slope[axis]) * part * part / 2;
  };
  allow(from, end, sign, at);
  if (start == BranchNodes::kNoNode) return up + to.energy;
  allow(to, nodes[start], -sign, 1 - at);
  return up + energy_between(nodes[start], to, axis, sign, at);
}

bool is_up(double rise, double allowed) { return !(rise <= allowed + kAllowedAtSnap); }

/// At how many of kPlaces places along the link the snap leads up too far.
int places_up(const Grid& grid, const BranchNodes& branches, const NodeEnergies& nodes,
              const OneWayLink& link) {
  int up = 0;
  for (int i = 0; i < kPlaces; ++i) {
    double allowed;
    const double rise = rise_at(grid, branches, nodes, link, (i + 0.5) / kPlaces, allowed);
    up += is_up(rise, allowed);
  }
  return up;
}

std::string unit_of_rises(const GridSpec& spec) {
  return "N " + (spec.length_unit.empty() ? "lengths" : printable_line(spec.length_unit));
}

/// Adds what a snap leads up at the part `at` of its link. The figures of the check are the largest
/// gain and the largest loss.
void add_rise(Check& check, const Grid& grid, const BranchNodes& branches,
              const NodeEnergies& nodes, const OneWayLink& link, double at) {
  double allowed;
  const double rise = rise_at(grid, branches, nodes, link, at, allowed);
  const double h = grid.box().spacing;
  const auto keep_larger = [&](Figure& largest, double value) {
    if (!(value * h > largest.value)) return;
    largest.value = value * h;
    largest.where = "where " + describe_link(grid, link.from, link.q) + " snaps";
  };
  keep_larger(check.figures[0], rise - allowed);
  keep_larger(check.figures[1], -rise);
  if (!is_up(rise, allowed)) return;
  check.found.offend(at_link(grid, link.from, link.q), [&] {
    return format("{}: the snap leads up by {} {}, allowed are {}",
                  describe_link(grid, link.from, link.q), rounded(rise * h), check.figures[0].unit,
                  rounded((allowed + kAllowedAtSnap) * h));
  });
}

/// Where on its way from s at x by d the model snaps, to half a place: the model does not come back
/// from behind the snap. NaN when a conversion fails; model.error() says why.
double snap_place(Model& model, std::span<const double> s, const Vec3& x, const Vec3& d) {
  std::vector<double> before(s.begin(), s.end()), middle(s.size()), back(s.size());
  double low = 0, high = 1;
  while (high - low > 1.0 / kPlaces) {
    const double half = (high - low) / 2;
    const Vec3 at = x + low * d, step = half * d;
    if (!model.convert(before.data(), at, step, middle.data()) ||
        !model.convert(middle.data(), at + step, -1 * step, back.data()))
      return std::nan("");
    if (model.equal(back.data(), before.data())) {
      low += half;
      before.swap(middle);
    } else {
      high = low + half;
    }
  }
  return (low + high) / 2;
}

/// The snaps whose place decides, where the model has them.
void ask(Check& check, const Grid& grid, const BranchNodes& branches, const NodeEnergies& nodes,
         const std::vector<OneWayLink>& links, const MakeModel& make_model, int threads) {
  if (links.empty()) return;
  if (!make_model) {
    check.not_proved = format(
        "{} of the snaps lead up or not, as the place between two points decides where the model "
        "snaps; to find it, leave out --recompute none",
        links.size());
    return;
  }
  std::vector<double> places(links.size());
  std::vector<std::string> errors(links.size());
  std::vector<std::unique_ptr<Model>> models;
  models.reserve(static_cast<std::size_t>(threads));
  for (int t = 0; t < threads; ++t) models.push_back(make_model());
  for_each_with_own(links.size(), models, [&](const std::unique_ptr<Model>& model, std::size_t i) {
    const auto& [point, r, q] = links[i];
    places[i] = snap_place(*model, grid.row(r), grid.box().position(grid.point(r)),
                           grid.neighbourhood().shift(q));
    if (std::isnan(places[i])) errors[i] = model->error();
  });
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (errors[i].empty())
      add_rise(check, grid, branches, nodes, links[i], places[i]);
    else
      check.found.offend(at_link(grid, links[i].from, links[i].q), [&] {
        return describe_link(grid, links[i].from, links[i].q) + ": " + errors[i];
      });
  }
}

}  // namespace

Check check_passive(const Grid& grid, const BranchNodes& branches, const NodeEnergies& nodes,
                    const MakeModel& make_model, int threads) {
  Check check = empty_check();
  for (const char* name : {"largest gain", "largest loss"})
    check.figures.push_back({name, 0, unit_of_rises(grid.spec()), ""});
  Findings& found = check.found;
  std::vector<OneWayLink> undecided;
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (int axis = 0; axis < 3; ++axis)
      for (const Direction towards : {Direction::up(axis).opposite(), Direction::up(axis)}) {
        const int q = towards.q();
        const RecordIndex target = grid.destination(r, q);
        if (target == Grid::kNoRecord) continue;
        ++found.counted;
        if (!is_finite_node(nodes[r]) || !is_finite_node(nodes[target])) {
          found.offend(at_link(grid, r, q), [&] {
            return describe_link(grid, r, q) + ": its energy or its force is not finite";
          });
          continue;
        }
        if (!grid.is_one_way(r, q)) continue;
        const OneWayLink link{grid.point(target), r, static_cast<std::uint8_t>(q)};
        if (const int up = places_up(grid, branches, nodes, link); up > 0 && up < kPlaces)
          undecided.push_back(link);
        else
          add_rise(check, grid, branches, nodes, link, 0.5);
      }
  ask(check, grid, branches, nodes, undecided, make_model, threads);
  return check;
}

Check passive_not_proved(std::string why) {
  Check check = empty_check();
  check.not_proved = std::move(why);
  return check;
}

}  // namespace hapgrid
