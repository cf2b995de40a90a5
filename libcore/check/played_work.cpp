#include "libcore/check/played_work.hpp"

#include <cmath>

#include "libcore/base/parallel.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

// What sums of forces may be off by, as a part of the forces: they are kept as floats.
constexpr double kRounding = 1e-6;
// A limit makes a kink in the force, which Gauss's rule does not see: so many pieces of a link make
// its error less than a thousandth of the change of the force along the link.
constexpr int kPieces = 16;
constexpr double kGauss = 0.5773502691896257;  // 1 / sqrt(3): exact for a cubic

/// The axis of a step along one axis, or -1.
int axis_of(int q) {
  const auto d = Direction(q).step();
  int axis = -1, count = 0;
  for (int a = 0; a < 3; ++a)
    if (d[a] != 0) {
      axis = a;
      ++count;
    }
  return count == 1 ? axis : -1;
}

}  // namespace

Vec3 ForceLimit::operator()(const Vec3& force) const noexcept {
  Vec3 felt{gain * force[0], gain * force[1], gain * force[2]};
  const double size = std::sqrt(dot(felt, felt));
  if (size > max_force)
    for (double& f : felt) f *= max_force / size;
  return felt;
}

PlayedWork::PlayedWork(const Grid& grid, const BranchMap& map, const NodeEnergies& nodes,
                       NodeForce::Interpolate interpolate, const ForceLimit& limit, int threads)
    : Work(grid),
      map_(map),
      nodes_(nodes),
      interpolate_(interpolate),
      limit_(limit),
      gains_(std::size_t{grid.records()} * 6) {
  constexpr std::uint64_t kBlock = 1 << 12;
  struct Nothing {
    void add(Nothing&&) {}
  };
  sum_of_blocks<Nothing>(grid.records(), kBlock, threads,
                         [&](std::uint64_t begin, std::uint64_t end) {
                           for (auto r = static_cast<RecordIndex>(begin); r < end; ++r)
                             for (int q = 0; q < kDirections; ++q)
                               if (takes(q) && grid_.destination(r, q) != Grid::kNoRecord)
                                 gains_[slot({r, q})] = integrate({r, q});
                           return Nothing{};
                         });
}

std::size_t PlayedWork::slot(const Link& link) {
  const int axis = axis_of(link.q);
  const bool is_up = Direction(link.q).step()[axis] > 0;
  return std::size_t{link.from} * 6 + static_cast<std::size_t>(2 * axis + is_up);
}

std::optional<double> PlayedWork::energy(RecordIndex r) const {
  if (interpolate_ != hermite_force) return std::nullopt;
  return limit_.gain * grid_.box().spacing * nodes_[r].energy;
}

bool PlayedWork::takes(int q) const { return axis_of(q) >= 0; }

/// On the edge from node `low` up to node `high`, from the part `begin` of it to the part `end`;
/// in newtons times the spacing.
double PlayedWork::along(Node low, Node high, int axis, double begin, double end) const {
  NodeCorners corners;
  for (int k = 0; k < 8; ++k) corners[k] = &nodes_[k >> axis & 1 ? high : low];
  const auto force = [&](double u) {
    Vec3 part{0, 0, 0};
    part[axis] = u;
    return limit_(interpolate_(corners, part))[axis];
  };
  const int pieces = limit_.cuts() ? kPieces : 1;
  double sum = 0;
  for (int i = 0; i < pieces; ++i) {
    const double half = (end - begin) / (2 * pieces);
    const double middle = begin + (2 * i + 1) * half;
    sum += half * (force(middle - kGauss * half) + force(middle + kGauss * half));
  }
  return sum;
}

/// Where play snaps off the branch of a one-way link, as a part of the way.
double PlayedWork::snap(const Link& link) const {
  const double here = map_.tear[link.from];
  const double there = map_.tear[map_.sheets.node(link.from, link.q)];
  return here / (here - there);
}

double PlayedWork::integrate(const Link& link) const {
  const int axis = axis_of(link.q);
  const RecordIndex target = grid_.destination(link.from, link.q);
  const bool is_up = Direction(link.q).step()[axis] > 0;
  const auto between = [&](Node from, Node to, double begin, double end) {
    return is_up ? along(from, to, axis, begin, end) : along(to, from, axis, 1 - begin, 1 - end);
  };
  double work = 0;
  if (is_reversible(link)) {
    work = between(link.from, target, 0, 1);
  } else {
    // Where the branch on which the hand goes on would have been from the beginning.
    const Node before = map_.sheets.node(target, Direction(link.q).opposite().q());
    const double at = snap(link);
    work = between(link.from, map_.sheets.node(link.from, link.q), 0, at);
    if (before != Sheets::kNoNode) work += between(before, target, at, 1);
  }
  return work * grid_.box().spacing;
}

double PlayedWork::allowance(const Link& link) const {
  const RecordIndex target = grid_.destination(link.from, link.q);
  const NodeEnergy &from = nodes_[link.from], &to = nodes_[target];
  double size = 0;
  for (int a = 0; a < 3; ++a) size += std::abs(from.slope[a]) + std::abs(to.slope[a]);
  double sum = kRounding * size;
  if (!is_reversible(link) && interpolate_ == hermite_force) {
    // Of the energies at the snap, what goes beyond the slopes of the two records: half of it is
    // allowed, because it was extrapolated.
    const int axis = axis_of(link.q);
    const double at = snap(link), sign = Direction(link.q).step()[axis];
    const Node end = map_.sheets.node(link.from, link.q);
    const Node before = map_.sheets.node(target, Direction(link.q).opposite().q());
    sum += std::abs(nodes_[end].energy - from.energy - sign * from.slope[axis]) * at * at / 2;
    if (before != Sheets::kNoNode)
      sum += std::abs(nodes_[before].energy - to.energy + sign * to.slope[axis]) * (1 - at) *
             (1 - at) / 2;
  }
  return limit_.gain * sum * grid_.box().spacing;
}

}  // namespace hapgrid
