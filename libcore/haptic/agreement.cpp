#include "libcore/haptic/agreement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "libcore/base/parallel.hpp"

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
  const LinksOfRecord links(grid, p, static_cast<Level>(r - grid.first(p)));
  for (int a = 0; a < 3; ++a) {
    const auto [up, down] = up_and_down(a);
    const RecordIndex high = links.two_way(up), low = links.two_way(down);
    if (high == Grid::kNoRecord || low == Grid::kNoRecord) continue;
    const double force = fields.force[r][a];
    const double sum = fields.force[low][a] + fields.force[high][a];
    const double slope = (fields.energy[high] - fields.energy[low]) / (2 * h);
    ++found.predictions;
    found.force += squared(force);
    found.by_forces += squared(force - sum / 2);
    found.by_energy += squared(force - (-1.5 * slope - sum / 4));
  }
}

}  // namespace

Agreement agreement(const Grid& grid, const RecordFields& fields) {
  // The stride is odd, so that not all runs are at the same places in the rows of the box.
  constexpr std::uint64_t kRun = 64, kEnough = 1 << 15;
  const std::uint64_t runs = (std::uint64_t{grid.records()} + kRun - 1) / kRun;
  const std::uint64_t stride = runs / kEnough | 1;
  Squares found = sum_of_blocks<Squares>(
      (runs + stride - 1) / stride, 256, all_threads(),
      [&](std::uint64_t begin, std::uint64_t end) {
        Squares sums;
        for (std::uint64_t i = begin; i < end; ++i) {
          const std::uint64_t first = i * stride * kRun;
          const auto last = std::min<std::uint64_t>(grid.records(), first + kRun);
          for (std::uint64_t r = first; r < last; ++r)
            predict(grid, fields, static_cast<RecordIndex>(r), sums);
        }
        return sums;
      });
  for (double* sum : {&found.force, &found.by_energy, &found.by_forces})
    *sum = std::sqrt(*sum / static_cast<double>(std::max<std::uint64_t>(1, found.predictions)));
  return found;
}

}  // namespace hapgrid
