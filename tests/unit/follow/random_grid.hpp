// Grids with random states and random links, for tests of whatever walks over grids.
#pragma once

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "libcore/follow/record_fields.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid::testing {

/// Appends a record. `level_at` gives the level at the other end of each link that stays in the
/// box.
template <class Row, class LevelAt>
void add_record(RecordColumns& columns, const Neighbourhood& around, PointIndex point, Level level,
                const Row& row, LevelAt&& level_at) {
  columns.point.push_back(point);
  columns.level.push_back(level);
  columns.generation.push_back(0);
  columns.rows.insert(columns.rows.end(), std::begin(row), std::end(row));
  for (int q = 0; q < kDirections; ++q) {
    const bool stays = around.inside(point) >> q & 1;
    const auto to = static_cast<PointIndex>(point + around.offset(q));
    columns.links.push_back(stays ? static_cast<Level>(level_at(to)) : kLeavesBox);
  }
}

/// A complete grid: each point has 1 .. `levels` levels, each with a random state in [-1, 1)^n and
/// links to random levels that exist. Generation 0, written by round 1: no frontier.
inline RecordColumns random_columns(const Box& box, std::uint32_t n, unsigned levels,
                                    std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const Neighbourhood around(box);
  std::vector<unsigned> count(box.points());
  for (unsigned& c : count) c = 1 + static_cast<unsigned>(random() % levels);
  RecordColumns columns;
  std::vector<double> state(n);
  for (PointIndex p = 0; p < box.points(); ++p)
    for (unsigned l = 0; l < count[p]; ++l) {
      for (double& s : state) s = static_cast<double>(random() >> 11) * 0x1p-52 - 1;
      add_record(columns, around, p, static_cast<Level>(l), state,
                 [&](PointIndex to) { return random() % count[to]; });
    }
  return columns;
}

inline GridSpec spec_for(const Box& box, std::uint32_t n) {
  GridSpec spec;
  spec.box = box;
  spec.state_size = n;
  return spec;
}

inline Grid random_grid(const Box& box, std::uint32_t n, unsigned levels, std::uint64_t seed) {
  return Grid(spec_for(box, n), 1, random_columns(box, n, levels, seed));
}

/// A number in [low, high).
inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

/// Energy and force at the records of a grid, from functions of the place.
template <class Energy, class Force>
RecordFields fields_of(const Grid& grid, Energy&& energy, Force&& force) {
  RecordFields fields;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    const Vec3 x = grid.box().position(grid.point(r));
    fields.energy.push_back(energy(x));
    fields.force.push_back(force(x));
  }
  return fields;
}

}  // namespace hapgrid::testing
