#include "libcore/check/steep.hpp"

#include "libcore/follow/traversal.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/check/tiny_grid.hpp"
#include "tests/unit/follow/random_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;
using tiny::figure;

static constexpr double kSpacing = 0.25;

TEST_CASE("no interpolated force is stiffer, and an edge is as steep") {
  std::mt19937_64 random(1);
  const Box box{{0, 0, 0}, kSpacing, {3, 4, 3}};
  const Grid grid = random_grid(box, 2, 1, 1);
  std::vector<Vec3> forces;
  for (RecordIndex r = 0; r < grid.records(); ++r)
    forces.push_back({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)});
  const Check check = check_steep(grid, forces);
  CHECK(check.is_note);
  CHECK(check.found.counted == grid.records());
  const double stiffness = 4000 / figure(check, "largest stable scale");

  double force = 0, state = 0, change = 0;
  const auto force_at = [&](const GridCoordinates& cell, const Vec3& part) {
    Vec3 f{0, 0, 0};
    const auto weights = corner_weights(part);
    for (unsigned k = 0; k < 8; ++k)
      f = f +
          weights[k] *
              forces[box.index({cell[0] + (k & 1), cell[1] + (k >> 1 & 1), cell[2] + (k >> 2)})];
    return f;
  };
  for (int trial = 0; trial < 20000; ++trial) {
    const GridCoordinates cell{static_cast<std::uint32_t>(random() % 2),
                               static_cast<std::uint32_t>(random() % 3),
                               static_cast<std::uint32_t>(random() % 2)};
    Vec3 from, to, way;
    for (int a = 0; a < 3; ++a) from[a] = uniform(random, 0, 0.999);
    for (int a = 0; a < 3; ++a) to[a] = from[a] + (way[a] = uniform(random, 0, 0.001));
    const double changed = length_of(force_at(cell, from) - force_at(cell, to));
    change = std::max(change, changed / length_of(way) / kSpacing);
  }
  CHECK(change < stiffness);
  CHECK(change > stiffness / 2);
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (const int q : {tiny::kRight, Direction::of(0, 1, 0).q(), Direction::of(0, 0, 1).q()}) {
      const RecordIndex to = grid.destination(r, q);
      if (to == Grid::kNoRecord) continue;
      force = std::max(force, length_of(forces[r] - forces[to]) / kSpacing);
      for (std::size_t c = 0; c < 2; ++c)
        state = std::max(state, std::abs(grid.state(r)[c] - grid.state(to)[c]) / kSpacing);
    }
  CHECK(figure(check, "force") == Approx(force));
  CHECK(figure(check, "state") == Approx(state));

  // Without forces the states remain.
  const Check states = check_steep(grid, {});
  CHECK(states.figures.size() == 1);
  CHECK(figure(states, "state") == figure(check, "state"));
  // Two components, compared by the plug-in itself: in which unit is not known.
  CHECK(states.figures[0].unit == "of a component/length");
}

TEST_CASE("a device is stable below K = 2 b f and not above") {
  // A spring of 100 N a length in x, one level: the figures are known.
  const Grid grid = random_grid({{0, 0, 0}, kSpacing, {4, 3, 3}}, 1, 1, 1);
  std::vector<Vec3> forces;
  for (RecordIndex r = 0; r < grid.records(); ++r)
    forces.push_back({-100 * grid.box().position(grid.point(r))[0], 0, 0});
  const Check free = check_steep(grid, forces);
  CHECK(figure(free, "force") == Approx(100));
  CHECK(figure(free, "largest stable scale") == Approx(2 * 2 * 1000 / 100.0));
  // The box is three spacings long in x; 4000 N/m are 100 N a length at 40 lengths a metre.
  CHECK(figure(free, "shortest stable reach") == Approx(3 * kSpacing / 40));
  CHECK(free.found.offenders == 0);
  CHECK(is_fine({free}));
}
