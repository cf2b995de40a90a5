#include "libcore/follow/node_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapgrid {

namespace {

/// Each mixed derivative is the mean of the slope along a, differentiated along b, and the other
/// way round. Where nothing pushes it stays 0, or force would leak into free cells. A contact is a
/// kink of the slope, so differences are not taken across it, but on the side of the contact alone.
void add_mixed(NodeEnergies& nodes, const Grid& grid, RecordIndex r) {
  const auto is_free = [](const NodeEnergy& node) { return node.slope == std::array<float, 3>{}; };
  NodeEnergy& node = nodes[r];
  if (is_free(node)) return;
  const auto pushed_beside = [&](int q) -> const NodeEnergy* {
    const RecordIndex to = grid.two_way(r, q);
    const NodeEnergy* const there = to == Grid::kNoRecord ? nullptr : &nodes[to];
    return there && is_free(*there) ? nullptr : there;
  };
  std::array<float, 3> sum{}, ways{};
  for (int a = 0; a < 3; ++a) {
    const Direction up = Direction::up(a);
    const NodeEnergy *low = pushed_beside(up.opposite().q()), *high = pushed_beside(up.q());
    if (!low && !high) continue;
    const float width = low && high ? 2.0F : 1.0F;
    if (!low) low = &node;
    if (!high) high = &node;
    for (int b = 0; b < 3; ++b) {
      if (b == a) continue;
      const int left_out = 3 - a - b;
      sum[left_out] += (high->slope[b] - low->slope[b]) / width;
      ++ways[left_out];
    }
  }
  for (int c = 0; c < 3; ++c) node.mixed[c] = ways[c] > 0 ? sum[c] / ways[c] : 0.0F;
}

/// Means over the records whose links lead to the ghost.
NodeEnergy of_ghost(const NodeEnergies& nodes, const Grid& grid, const BranchNodes& branches,
                    Node ghost) {
  const auto weight_of = [](const std::array<int, 3>& d) {
    return 1.0 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  };
  double weights = 0, weights_ahead = 0;
  std::array<double, 3> slope{}, slope_ahead{}, mixed{};
  for (const auto& [point, r, q] : branches.links_into_ghost(ghost)) {
    const NodeEnergy& node = nodes[r];
    const double weight = weight_of(Direction(q).step());
    const RecordIndex behind = grid.two_way(r, Direction(q).opposite().q());
    weights += weight;
    if (behind != Grid::kNoRecord) weights_ahead += weight;
    for (int c = 0; c < 3; ++c) {
      slope[c] += weight * node.slope[c];
      mixed[c] += weight * node.mixed[c];
      if (behind != Grid::kNoRecord)
        slope_ahead[c] += weight * (2 * double{node.slope[c]} - nodes[behind].slope[c]);
    }
  }
  NodeEnergy found;
  for (int c = 0; c < 3; ++c) {
    found.slope[c] =
        static_cast<float>(weights_ahead > 0 ? slope_ahead[c] / weights_ahead : slope[c] / weights);
    found.mixed[c] = static_cast<float>(mixed[c] / weights);
  }
  double energies = 0;
  float settled =
      -std::numeric_limits<float>::infinity();  // of the records to which the links lead
  for (const auto& [point, r, q] : branches.links_into_ghost(ghost)) {
    const NodeEnergy& node = nodes[r];
    const auto d = Direction(q).step();
    double energy = node.energy;
    for (int c = 0; c < 3; ++c) energy += (node.slope[c] + found.slope[c]) / 2 * d[c];
    energies += weight_of(d) * energy;
    settled = std::max(settled, nodes[grid.destination(r, q)].energy);
  }
  found.energy = std::max(static_cast<float>(energies / weights), settled);
  return found;
}

}  // namespace

NodeEnergies node_energies(const Grid& grid, const RecordFields& fields,
                           const BranchNodes* branches) {
  NodeEnergies nodes(grid.records());
  // Energies are large against their differences: only what is above the lowest one fits a float.
  double lowest = std::numeric_limits<double>::infinity();
  for (const double energy : fields.energy) lowest = std::min(lowest, energy);
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    NodeEnergy& node = nodes[r];
    if (!fields.energy.empty())
      node.energy = static_cast<float>((fields.energy[r] - lowest) / grid.box().spacing);
    for (int a = 0; a < 3; ++a) node.slope[a] = static_cast<float>(-fields.force[r][a]);
  }
  for (RecordIndex r = 0; r < grid.records(); ++r) add_mixed(nodes, grid, r);
  if (branches) add_ghosts(nodes, grid, *branches);
  return nodes;
}

void add_ghosts(NodeEnergies& nodes, const Grid& grid, const BranchNodes& branches) {
  nodes.reserve(nodes.size() + branches.ghosts());
  for (Node i = 0; i < branches.ghosts(); ++i)
    nodes.push_back(of_ghost(nodes, grid, branches, grid.records() + i));
}

double largest_force(const NodeEnergies& nodes) {
  double largest = 0;
  for (const NodeEnergy& node : nodes) {
    const auto [x, y, z] = node.slope;
    const double force = std::sqrt(static_cast<double>(x * x + y * y + z * z));
    if (std::isfinite(force)) largest = std::max(largest, force);
  }
  return largest;
}

namespace {

/// The functions of one axis at u, by the corner's bit: of the value and of the slope, and their
/// derivatives.
struct Hermite {
  explicit Hermite(double u)
      : value{(1 - u) * (1 - u) * (1 + 2 * u), u * u * (3 - 2 * u)},
        slope{u * (1 - u) * (1 - u), -u * u * (1 - u)},
        d_value{-6 * u * (1 - u), 6 * u * (1 - u)},
        d_slope{(1 - u) * (1 - 3 * u), u * (3 * u - 2)} {}
  double value[2], slope[2], d_value[2], d_slope[2];
};

}  // namespace

double hermite_energy(const NodeCorners& corners, const Vec3& part) noexcept {
  const Hermite x(part[0]), y(part[1]), z(part[2]);
  double sum = 0;
  for (int k = 0; k < 8; ++k) {
    const int i = k & 1, j = k >> 1 & 1, l = k >> 2;
    const NodeEnergy& n = *corners[k];
    sum += x.value[i] * (y.value[j] * (n.energy * z.value[l] + n.slope[2] * z.slope[l]) +
                         y.slope[j] * (n.slope[1] * z.value[l] + n.mixed[0] * z.slope[l])) +
           x.slope[i] * (y.value[j] * (n.slope[0] * z.value[l] + n.mixed[1] * z.slope[l]) +
                         y.slope[j] * n.mixed[2] * z.value[l]);
  }
  return sum;
}

/// The sum above, differentiated; along z first, so that each product is made once.
Vec3 hermite_force(const NodeCorners& corners, const Vec3& part) noexcept {
  const Hermite x(part[0]), y(part[1]), z(part[2]);
  Vec3 force{0, 0, 0};
  for (int i = 0; i < 2; ++i) {
    // On the edges of this side of the cell: the energy and its slope along x, after y and z.
    double e = 0, e_y = 0, e_z = 0, s = 0, s_y = 0, s_z = 0;
    for (int j = 0; j < 2; ++j) {
      const NodeEnergy &low = *corners[i + 2 * j], &high = *corners[i + 2 * j + 4];
      const auto along = [&](const auto& value, const auto& slope, double at, double low_slope,
                             double at_high, double high_slope) {
        return value(low) * at + slope(low) * low_slope + value(high) * at_high +
               slope(high) * high_slope;
      };
      const auto sum = [&](const auto& value, const auto& slope) {
        return along(value, slope, z.value[0], z.slope[0], z.value[1], z.slope[1]);
      };
      const auto d_sum = [&](const auto& value, const auto& slope) {
        return along(value, slope, z.d_value[0], z.d_slope[0], z.d_value[1], z.d_slope[1]);
      };
      constexpr auto energy = [](const NodeEnergy& n) -> double { return n.energy; };
      constexpr auto by_x = [](const NodeEnergy& n) -> double { return n.slope[0]; };
      constexpr auto by_y = [](const NodeEnergy& n) -> double { return n.slope[1]; };
      constexpr auto by_z = [](const NodeEnergy& n) -> double { return n.slope[2]; };
      constexpr auto by_yz = [](const NodeEnergy& n) -> double { return n.mixed[0]; };
      constexpr auto by_xz = [](const NodeEnergy& n) -> double { return n.mixed[1]; };
      const double at = sum(energy, by_z), at_x = sum(by_x, by_xz), at_y = sum(by_y, by_yz);
      const double at_xy = low.mixed[2] * z.value[0] + high.mixed[2] * z.value[1];
      e += at * y.value[j] + at_y * y.slope[j];
      e_y += at * y.d_value[j] + at_y * y.d_slope[j];
      e_z += d_sum(energy, by_z) * y.value[j] + d_sum(by_y, by_yz) * y.slope[j];
      s += at_x * y.value[j] + at_xy * y.slope[j];
      s_y += at_x * y.d_value[j] + at_xy * y.d_slope[j];
      s_z += d_sum(by_x, by_xz) * y.value[j] +
             (low.mixed[2] * z.d_value[0] + high.mixed[2] * z.d_value[1]) * y.slope[j];
    }
    force[0] -= e * x.d_value[i] + s * x.d_slope[i];
    force[1] -= e_y * x.value[i] + s_y * x.slope[i];
    force[2] -= e_z * x.value[i] + s_z * x.slope[i];
  }
  return force;
}

Vec3 mean_force(const NodeCorners& corners, const Vec3& part) noexcept {
  const std::array<double, 8> weights = corner_weights(part);
  Vec3 force{0, 0, 0};
  for (int k = 0; k < 8; ++k)
    for (int a = 0; a < 3; ++a) force[a] -= weights[k] * corners[k]->slope[a];
  return force;
}

NodeCorners NodeForce::corners_of(const std::array<RecordIndex, 8>& nodes) const noexcept {
  NodeCorners corners{};
  for (int k = 0; k < 8; ++k) corners[k] = &(*energies_)[nodes[k]];
  return corners;
}

Vec3 NodeForce::operator()(const Traversal& traversal) noexcept {
  const StepResult& step = traversal.last_step();
  const NodeCorners corners = corners_of(traversal.nodes());
  const bool jumps = step.jumped() || step.split;
  offset_.fade(traversal.corners_before().from, traversal.position());
  if (jumps)
    offset_.end();
  else if (traversal.corners_before().have_changed)
    keep_force(traversal, corners);
  follow(traversal, corners, jumps);
  done_ = step.started ? 0 : done_ + dot(added_, traversal.position() - at_);
  at_ = traversal.position();
  Vec3 force = interpolate_(corners, traversal.part());
  added_ = {0, 0, 0};
  offset_.add_to(added_);
  return force + added_;
}

void NodeForce::follow(const Traversal& traversal, const NodeCorners& corners,
                       bool jumps) noexcept {
  if (traversal.follows_as_before() && offset_.is_held()) return;
  const BesideAnswer* const answer = traversal.followed();
  if (!answer || !answer->force) return offset_.let_go();
  const Vec3 missing =
      *answer->force - interpolate_(corners, traversal.walk().part_beside_cell(answer->at));
  offset_.hold(missing, jumps);
}

/// Where corners that the cell shares with the one before have changed, the force goes on from
/// where it was. Both are asked at one place, the one in both cells that is nearest to where the
/// step began.
void NodeForce::keep_force(const Traversal& traversal, const NodeCorners& corners) noexcept {
  const CornersBefore& corners_before = traversal.corners_before();
  Vec3 before = traversal.walk().part_of_cell(corners_before.from), after = before;
  if (corners_before.direction >= 0) {
    const auto move = Direction(corners_before.direction).step();
    for (int a = 0; a < 3; ++a) {
      if (move[a] == 0) continue;
      before[a] = move[a] > 0 ? 1 : 0;
      after[a] = move[a] > 0 ? 0 : 1;
    }
  }
  const Vec3 had = interpolate_(corners_of(corners_before.nodes), before);
  const Vec3 has = interpolate_(corners, after);
  const std::span<double> offset = offset_.renew();
  for (std::size_t a = 0; a < 3; ++a) offset[a] = offset[a] + had[a] - has[a];
}

}  // namespace hapgrid
