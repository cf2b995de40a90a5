#include "libcore/haptic/node_energies.hpp"

#include <algorithm>
#include <limits>

#include "libcore/base/parallel.hpp"

namespace hapgrid {

namespace {

/// The record that a two-way link in direction q connects with r, or kNoRecord.
/// @param sheets may be null, which takes longer
RecordIndex beside(const Grid& grid, const Sheets* sheets, RecordIndex r, int q) {
  const bool is_one_way = sheets ? sheets->one_way(r) >> q & 1 : grid.is_one_way(r, q);
  return is_one_way ? Grid::kNoRecord : grid.destination(r, q);
}

int along(int axis, int step) {
  std::array<int, 3> d{0, 0, 0};
  d[axis] = step;
  return Direction::of(d[0], d[1], d[2]).q();
}

}  // namespace

NodeEnergies::NodeEnergies(const Grid& grid, const Sheets* sheets, const RecordFields& fields)
    : records_(grid.records()),
      slots_(fields.slots),
      ghosts_(slots_.size(records_)),
      nodes_(ghosts_ + (sheets ? sheets->ghosts() : 0)) {
  // Energies are large against their differences: only what is above the lowest one fits a float.
  double lowest = std::numeric_limits<double>::infinity();
  for (const double energy : fields.energy) lowest = std::min(lowest, energy);
  for (std::size_t i = 0; i < ghosts_; ++i) {
    NodeEnergy& node = nodes_[i];
    if (!fields.energy.empty())
      node.energy = static_cast<float>((fields.energy[i] - lowest) / grid.box().spacing);
    for (int a = 0; a < 3; ++a) node.slope[a] = static_cast<float>(-fields.force[i][a]);
  }
  // No mixed derivative depends on another one.
  constexpr std::size_t kWords = 256;
  const std::size_t words = std::size_t{records_} / 64 + 1;
  for_each_in_threads((words + kWords - 1) / kWords, all_threads(), [&](std::size_t b) {
    const std::size_t begin = b * kWords, end = std::min(words, begin + kWords);
    const auto add = [&](std::size_t r) { add_mixed(grid, sheets, static_cast<RecordIndex>(r)); };
    if (slots_.is_shared())
      slots_.own().for_each(begin, std::min(end, slots_.own().words()), add);
    else
      for (std::size_t r = begin * 64; r < std::min<std::size_t>(end * 64, records_); ++r) add(r);
  });
  if (sheets) add_ghosts(grid, *sheets);
}

/// Each mixed derivative is the mean of the slope along a, differentiated along b, and the other
/// way round. Where nothing pushes it stays 0, or force would leak into free cells. A contact is a
/// kink of the slope, so differences are not taken across it, but on the side of the contact alone.
void NodeEnergies::add_mixed(const Grid& grid, const Sheets* sheets, RecordIndex r) {
  const auto free = [&](RecordIndex record) {
    return (*this)[record].slope == std::array<float, 3>{};
  };
  const auto pushed_beside = [&](int q) {
    const RecordIndex to = beside(grid, sheets, r, q);
    return to != Grid::kNoRecord && free(to) ? Grid::kNoRecord : to;
  };
  if (free(r)) return;
  std::array<float, 3> sum{}, ways{};
  for (int a = 0; a < 3; ++a) {
    RecordIndex low = pushed_beside(along(a, -1)), high = pushed_beside(along(a, 1));
    const float width = low != Grid::kNoRecord && high != Grid::kNoRecord ? 2.0F : 1.0F;
    if (low == Grid::kNoRecord) low = r;
    if (high == Grid::kNoRecord) high = r;
    if (low == high) continue;
    for (int b = 0; b < 3; ++b) {
      if (b == a) continue;
      const int left_out = 3 - a - b;
      sum[left_out] += ((*this)[high].slope[b] - (*this)[low].slope[b]) / width;
      ++ways[left_out];
    }
  }
  NodeEnergy& node = nodes_[slots_[r]];
  for (int c = 0; c < 3; ++c) node.mixed[c] = ways[c] > 0 ? sum[c] / ways[c] : 0.0F;
}

void NodeEnergies::add_ghosts(const Grid& grid, const Sheets& sheets) {
  /// Sums over the records whose links lead to a ghost's point, each with a weight.
  struct Sum {
    double weight = 0;
    std::array<double, 3> slope{}, mixed{};
    double energy = 0;
    float settled = -std::numeric_limits<float>::infinity();  // of the records there
  };
  std::vector<Sum> ahead(sheets.ghosts()), beside_it(sheets.ghosts());
  const auto for_each_end = [&](auto&& use) {
    sheets.for_each_end([&](RecordIndex r, int q) {
      const auto d = Direction(q).step();
      use(r, q, sheets.node(r, q) - records_, d, 1.0 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    });
  };
  for_each_end([&](RecordIndex r, int q, Node ghost, const auto&, double weight) {
    const RecordIndex behind = beside(grid, &sheets, r, Direction(q).opposite().q());
    Sum& mean = beside_it[ghost];
    mean.weight += weight;
    if (behind != Grid::kNoRecord) ahead[ghost].weight += weight;
    for (int c = 0; c < 3; ++c) {
      const double slope = (*this)[r].slope[c];
      mean.slope[c] += weight * slope;
      mean.mixed[c] += weight * (*this)[r].mixed[c];
      if (behind != Grid::kNoRecord)
        ahead[ghost].slope[c] += weight * (2 * slope - (*this)[behind].slope[c]);
    }
  });
  for (Node ghost = 0; ghost < sheets.ghosts(); ++ghost) {
    const Sum& mean = beside_it[ghost];
    const Sum& slopes = ahead[ghost].weight > 0 ? ahead[ghost] : mean;
    NodeEnergy& node = nodes_[ghosts_ + ghost];
    for (int c = 0; c < 3; ++c) {
      node.slope[c] = static_cast<float>(slopes.slope[c] / slopes.weight);
      node.mixed[c] = static_cast<float>(mean.mixed[c] / mean.weight);
    }
  }
  for_each_end([&](RecordIndex r, int q, Node ghost, const auto& d, double weight) {
    double energy = (*this)[r].energy;
    for (int c = 0; c < 3; ++c)
      energy += ((*this)[r].slope[c] + nodes_[ghosts_ + ghost].slope[c]) / 2 * d[c];
    Sum& sum = beside_it[ghost];
    sum.energy += weight * energy;
    sum.settled = std::max(sum.settled, (*this)[grid.destination(r, q)].energy);
  });
  for (Node ghost = 0; ghost < sheets.ghosts(); ++ghost) {
    const Sum& sum = beside_it[ghost];
    nodes_[ghosts_ + ghost].energy =
        std::max(static_cast<float>(sum.energy / sum.weight), sum.settled);
  }
}

}  // namespace hapgrid
