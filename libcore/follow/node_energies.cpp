#include "libcore/follow/node_energies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapgrid {

NodeEnergies::NodeEnergies(const Grid& grid, const RecordFields& fields) : nodes_(grid.records()) {
  // Energies are large against their differences: only what is above the lowest one fits a float.
  double lowest = std::numeric_limits<double>::infinity();
  for (const double energy : fields.energy) lowest = std::min(lowest, energy);
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    NodeEnergy& node = nodes_[r];
    if (!fields.energy.empty())
      node.energy = static_cast<float>((fields.energy[r] - lowest) / grid.box().spacing);
    for (int a = 0; a < 3; ++a) node.slope[a] = static_cast<float>(-fields.force[r][a]);
  }
  for (RecordIndex r = 0; r < grid.records(); ++r) add_mixed(grid, r);
}

/// Each mixed derivative is the mean of the slope along a, differentiated along b, and the other
/// way round. Where nothing pushes it stays 0, or force would leak into free cells. A contact is a
/// kink of the slope, so differences are not taken across it, but on the side of the contact alone.
void NodeEnergies::add_mixed(const Grid& grid, RecordIndex r) {
  const auto is_free = [](const NodeEnergy& node) { return node.slope == std::array<float, 3>{}; };
  NodeEnergy& node = nodes_[r];
  if (is_free(node)) return;
  const auto pushed_beside = [&](int q) -> const NodeEnergy* {
    const RecordIndex to = grid.two_way(r, q);
    const NodeEnergy* const there = to == Grid::kNoRecord ? nullptr : &(*this)[to];
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

void NodeEnergies::add_ghosts(const Grid& grid, const BranchNodes& branches) {
  nodes_.reserve(nodes_.size() + branches.ghosts());
  for (Node i = 0; i < branches.ghosts(); ++i)
    nodes_.push_back(of_ghost(grid, branches, grid.records() + i));
}

double NodeEnergies::largest_force() const {
  double largest = 0;
  for (const NodeEnergy& node : nodes_) {
    const auto [x, y, z] = node.slope;
    const double force = std::sqrt(static_cast<double>(x * x + y * y + z * z));
    if (std::isfinite(force)) largest = std::max(largest, force);
  }
  return largest;
}

/// Means over the records whose links lead to the ghost.
NodeEnergy NodeEnergies::of_ghost(const Grid& grid, const BranchNodes& branches, Node ghost) const {
  const auto weight_of = [](const std::array<int, 3>& d) {
    return 1.0 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  };
  double weights = 0, weights_ahead = 0;
  std::array<double, 3> slope{}, slope_ahead{}, mixed{};
  for (const auto& [point, r, q] : branches.links_into_ghost(ghost)) {
    const NodeEnergy& node = (*this)[r];
    const double weight = weight_of(Direction(q).step());
    const RecordIndex behind = grid.two_way(r, Direction(q).opposite().q());
    weights += weight;
    if (behind != Grid::kNoRecord) weights_ahead += weight;
    for (int c = 0; c < 3; ++c) {
      slope[c] += weight * node.slope[c];
      mixed[c] += weight * node.mixed[c];
      if (behind != Grid::kNoRecord)
        slope_ahead[c] += weight * (2 * double{node.slope[c]} - (*this)[behind].slope[c]);
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
    const NodeEnergy& node = (*this)[r];
    const auto d = Direction(q).step();
    double energy = node.energy;
    for (int c = 0; c < 3; ++c) energy += (node.slope[c] + found.slope[c]) / 2 * d[c];
    energies += weight_of(d) * energy;
    settled = std::max(settled, (*this)[grid.destination(r, q)].energy);
  }
  found.energy = std::max(static_cast<float>(energies / weights), settled);
  return found;
}

}  // namespace hapgrid
