#include "libcore/haptic/agreement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libcore/base/parallel.hpp"
#include "libcore/grid/point_bits.hpp"

namespace hapgrid {

namespace {

double squared(double x) { return x * x; }

/// Sums of squares, of the predictions at some records.
struct Squares : Agreement {
  void add(const Squares& other) {
    predictions += other.predictions;
    force += other.force;
    by_energy += other.by_energy;
    by_forces += other.by_forces;
  }
};

/// The directions up and down an axis.
std::array<int, 2> up_and_down(int axis) {
  std::array<int, 3> d{0, 0, 0};
  d[axis] = 1;
  const Direction up = Direction::of(d[0], d[1], d[2]);
  return {up.q(), up.opposite().q()};
}

void predict(const Grid& grid, const RecordFields& fields, RecordIndex r, Squares& found) {
  const double h = grid.box().spacing;
  const PointIndex p = grid.point(r);
  const auto level = static_cast<Level>(r - grid.first(p));
  for (int a = 0; a < 3; ++a) {
    const auto [up, down] = up_and_down(a);
    const RecordIndex high = grid.destination(r, up), low = grid.destination(r, down);
    if (high == Grid::kNoRecord || low == Grid::kNoRecord || grid.is_one_way(p, level, up) ||
        grid.is_one_way(p, level, down))
      continue;
    const std::size_t here = fields.slots[r], above = fields.slots[high], below = fields.slots[low];
    const double force = fields.force[here][a];
    const double sum = fields.force[below][a] + fields.force[above][a];
    const double slope = (fields.energy[above] - fields.energy[below]) / (2 * h);
    ++found.predictions;
    found.force += squared(force);
    found.by_forces += squared(force - sum / 2);
    found.by_energy += squared(force - (-1.5 * slope - sum / 4));
  }
}

/// The points where a prediction is not just 0 of what records share, and where links decide
/// whether there is one.
PointBits points_to_predict(const Grid& grid, const RecordFields& fields) {
  PointBits bits((grid.box().points() + 63) / 64);
  fields.slots.own().for_each(0, fields.slots.own().words(), [&](std::size_t r) {
    const PointIndex p = grid.point(static_cast<RecordIndex>(r));
    bits[p / 64] |= std::uint64_t{1} << p % 64;
  });
  bits = grown(std::move(bits), grid.box());
  const PointBits tangled = tangled_points(grid, all_threads());
  for (std::size_t w = 0; w < bits.size(); ++w) bits[w] |= tangled[w];
  return bits;
}

/// How many predictions there are at all other points, whose records have links to records of their
/// own level in all directions.
std::uint64_t predictions_elsewhere(const Grid& grid, const PointBits& looked_at) {
  struct Count {
    std::uint64_t count = 0;
    void add(const Count& other) { count += other.count; }
  };
  const Neighbourhood& around = grid.neighbourhood();
  const std::array<std::array<int, 2>, 3> ways{up_and_down(0), up_and_down(1), up_and_down(2)};
  const auto at = [&](PointIndex p, int q) {
    return grid.levels(static_cast<PointIndex>(p + around.offset(q)));
  };
  return sum_of_blocks<Count>(
             grid.box().points(), 1 << 14, all_threads(),
             [&](std::uint64_t begin, std::uint64_t end) {
               Count sum;
               InsideOfRun inside_of(grid.box(), around);
               for (std::uint64_t point = begin; point < end; ++point) {
                 if (looked_at[point / 64] >> point % 64 & 1) continue;
                 const auto p = static_cast<PointIndex>(point);
                 const DirectionMask inside = inside_of(p);
                 const RecordIndex levels = grid.levels(p);
                 for (const auto& [up, down] : ways)
                   if ((inside >> up & 1) && (inside >> down & 1))
                     sum.count += levels == 1 ? 1 : std::min({levels, at(p, up), at(p, down)});
               }
               return sum;
             })
      .count;
}

}  // namespace

Agreement agreement(const Grid& grid, const RecordFields& fields) {
  Squares found;
  const auto look_at = [&](RecordIndex begin, RecordIndex end, Squares& sums) {
    for (RecordIndex r = begin; r < end; ++r) predict(grid, fields, r, sums);
  };
  if (fields.slots.is_shared()) {
    const PointBits points = points_to_predict(grid, fields);
    found = sum_of_points<Squares>(points, all_threads(), [&](PointIndex p, Squares& sums) {
      look_at(grid.first(p), grid.first(p) + grid.levels(p), sums);
    });
    found.predictions += predictions_elsewhere(grid, points);
  } else {
    found = sum_of_blocks<Squares>(
        grid.records(), 1 << 14, all_threads(), [&](std::uint64_t begin, std::uint64_t end) {
          Squares sums;
          look_at(static_cast<RecordIndex>(begin), static_cast<RecordIndex>(end), sums);
          return sums;
        });
  }
  for (double* sum : {&found.force, &found.by_energy, &found.by_forces})
    *sum = std::sqrt(*sum / static_cast<double>(std::max<std::uint64_t>(1, found.predictions)));
  return found;
}

}  // namespace hapgrid
