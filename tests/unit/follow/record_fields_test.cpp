// Whether the forces of a grid are the gradient of its energies.
#include "libcore/follow/record_fields.hpp"

#include "tests/unit/catch.hpp"
#include "tests/unit/follow/random_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

TEST_CASE("what tells an energy whose gradient the force is from one that is spoilt") {
  // Two wells that cross in the middle of 10 points a side.
  const Box box{{-1, -1, -1}, 2.0 / 9, {10, 10, 10}};
  const Grid grid = random_grid(box, 1, 1, 5);
  const auto energy = [](const Vec3& x) {
    return std::sin(2 * x[0]) * std::cos(x[1]) + std::exp(-x[2] * x[2] + x[0] * x[1]);
  };
  const auto force = [&](const Vec3& x) {
    const double e = std::exp(-x[2] * x[2] + x[0] * x[1]);
    return Vec3{-2 * std::cos(2 * x[0]) * std::cos(x[1]) - x[1] * e,
                std::sin(2 * x[0]) * std::sin(x[1]) - x[0] * e, 2 * x[2] * e};
  };
  const RecordFields honest = fields_of(grid, energy, force);
  CHECK(agreement(grid, honest).is_good());
  RecordFields fifth = honest;
  for (double& e : fifth.energy) e *= 1.2;
  CHECK_FALSE(agreement(grid, fifth).is_good());
  const RecordFields curl = fields_of(grid, energy, [&](const Vec3& x) {
    return force(x) + 0.2 * Vec3{-x[1], x[0], 0};
  });
  CHECK_FALSE(agreement(grid, curl).is_good());

  // A linear force leaves no error to either of the predictions.
  const auto spring = [](const Vec3& x) { return Vec3{-x[0], -2 * x[1], -3 * x[2]}; };
  for (const double share : {0.5, 0.6}) {
    const auto work = [&](const Vec3& x) { return -share * dot(spring(x), x); };
    CHECK(agreement(grid, fields_of(grid, work, spring)).is_good() == (share == 0.5));
  }

  // A table has forces by central differences of its energies: half of the error of their mean, and
  // small where the table is fine. What the mean predicts exactly the energy may miss by 5 %: 1.5
  // of the part that it is off by.
  const Box fine{{-1, -1, -1}, 2.0 / 19, {20, 20, 20}};
  const double step = fine.spacing;
  const auto difference = [&](const Vec3& x) {
    Vec3 f;
    for (int a = 0; a < 3; ++a) {
      Vec3 low = x, high = x;
      low[a] -= step, high[a] += step;
      f[a] = (energy(low) - energy(high)) / (2 * step);
    }
    return f;
  };
  const Grid table = random_grid(fine, 1, 1, 5);
  const Agreement of_table = agreement(table, fields_of(table, energy, difference));
  CHECK(of_table.by_energy == Approx(0.5 * of_table.by_forces).epsilon(1e-9));
  CHECK(of_table.is_good());
  for (const double off : {0.03, 0.04}) {
    const auto work = [&](const Vec3& x) { return -(0.5 + off / 2) * dot(spring(x), x); };
    const Agreement found = agreement(grid, fields_of(grid, work, spring));
    CHECK(found.by_energy == Approx(1.5 * off * found.force));
    CHECK(found.by_energy > found.by_forces);
    CHECK(found.is_good() == (off < 0.05 / 1.5));
  }

  // Two points an axis predict nothing.
  const Grid small = random_grid({{0, 0, 0}, 1, {2, 2, 2}}, 1, 1, 5);
  CHECK_FALSE(agreement(small, fields_of(small, energy, force)).is_good());
}
