#include "libcore/check/passive.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/haptic/node_force.hpp"

namespace hapgrid {

namespace {

// What energies may be off by, as a part of the forces: they are kept as floats.
constexpr double kRounding = 1e-6;
// What the hand may gain by a snap: what a friction of so many newtons takes along two spacings. No
// closed walk through a one-way link has less than four, since the straight way back leads
// elsewhere; common devices have more friction (Geomagic Touch: 0.26 N).
constexpr double kFriction = 0.2;
constexpr double kAllowedAtSnap = 2 * kFriction;  // in newtons times the spacing

/// The energies at a snap, in newtons times the spacing.
struct Snap {
  double before, behind;
  double allowed;  // for what is extrapolated
};

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

/// On the one-way link of record r that leads one step along an axis, forwards or backwards.
Snap snap_on(const Grid& grid, const BranchMap& map, const NodeEnergies& nodes, RecordIndex r,
             int axis, int sign) {
  std::array<int, 3> step{0, 0, 0};
  step[axis] = sign;
  const Direction towards = Direction::of(step[0], step[1], step[2]);
  const RecordIndex target = grid.destination(r, towards.q());
  // Where the branch of either record is, on the other side of the link.
  const Node end = map.nodes.node(r, towards.q());
  const Node start = map.nodes.node(target, towards.opposite().q());
  const double at = map.tear[r] / (double{map.tear[r]} - map.tear[end]);
  const NodeEnergy &from = nodes[r], &to = nodes[target];

  Snap snap{energy_between(from, nodes[end], axis, sign, at), to.energy, 0};
  for (int a = 0; a < 3; ++a)
    snap.allowed += kRounding * (std::abs(from.slope[a]) + std::abs(to.slope[a]));
  const auto allow = [&](const NodeEnergy& record, const NodeEnergy& beyond, int way, double part) {
    snap.allowed +=
        std::abs(beyond.energy - record.energy - way * record.slope[axis]) * part * part / 2;
  };
  allow(from, nodes[end], sign, at);
  if (start != BranchNodes::kNoNode) {
    snap.behind = energy_between(nodes[start], to, axis, sign, at);
    allow(to, nodes[start], -sign, 1 - at);
  }
  return snap;
}

}  // namespace

Check check_passive(const Grid& grid, const BranchMap& map, const NodeEnergies& nodes) {
  Check check{"passive", "links", "snaps that lead up, so that a closed walk gains energy", {}};
  const double spacing = grid.box().spacing;
  const std::string unit =
      "N " +
      (grid.spec().length_unit.empty() ? "lengths" : printable_line(grid.spec().length_unit));
  Figure gain{"largest gain", 0, unit, ""}, loss{"largest loss", 0, unit, ""};
  const auto keep_larger = [&](Figure& largest, double value, RecordIndex r, int q) {
    if (!(value * spacing > largest.value)) return;
    largest.value = value * spacing;
    largest.where = "where " + describe_link(grid, r, q) + " snaps";
  };
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (int axis = 0; axis < 3; ++axis)
      for (const int sign : {-1, 1}) {
        std::array<int, 3> step{0, 0, 0};
        step[axis] = sign;
        const int q = Direction::of(step[0], step[1], step[2]).q();
        const RecordIndex target = grid.destination(r, q);
        if (target == Grid::kNoRecord) continue;
        ++check.found.counted;
        if (!is_finite_node(nodes[r]) || !is_finite_node(nodes[target])) {
          check.found.offend(location_of(grid, r, q), [&] {
            return describe_link(grid, r, q) + ": its energy or its force is not finite";
          });
          continue;
        }
        if (!grid.is_one_way(r, q)) continue;
        const Snap snap = snap_on(grid, map, nodes, r, axis, sign);
        const double up = snap.behind - snap.before;
        keep_larger(gain, up - snap.allowed, r, q);
        keep_larger(loss, -up, r, q);
        if (!(up <= snap.allowed + kAllowedAtSnap))
          check.found.offend(location_of(grid, r, q), [&] {
            return format("{}: the snap leads up by {} {}, allowed are {}",
                          describe_link(grid, r, q), rounded(up * spacing), unit,
                          rounded((snap.allowed + kAllowedAtSnap) * spacing));
          });
      }
  check.figures = {gain, loss};
  return check;
}

Check passive_not_proved(std::string why) {
  Check check{"passive", "links", "snaps that lead up, so that a closed walk gains energy", {}};
  check.not_proved = std::move(why);
  return check;
}

}  // namespace hapgrid
