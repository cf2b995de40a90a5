#include "libcore/check/steep.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "libcore/check/passive.hpp"
#include "libcore/check/trapezoid_work.hpp"
#include "tests/unit/check/oracle.hpp"
#include "tests/unit/haptic/random_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

constexpr double kSpacing = 0.25;

/// A random grid that stores a force; states of two numbers.
Grid grid_with_force(const GridCoordinates& counts, unsigned levels, std::uint64_t seed) {
  GridSpec spec = spec_for({{0, 0, 0}, kSpacing, counts}, 2);
  spec.stored.force = true;
  return Grid(spec, 1, random_columns(spec.box, spec.row_size(), levels, seed));
}

Forces stored_forces(const Grid& grid) {
  const auto none = []() -> std::unique_ptr<Model> { throw std::logic_error("not needed"); };
  return Forces(record_fields(grid, none, 2).force);
}

double norm(const Vec3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/// What play has somewhere in its cell, given as parts along the axes.
std::vector<double> row_at(const Box& box, const PaperTraversal& t, const Vec3& part) {
  PaperTraversal there(t);
  REQUIRE(there.step(inside(box, t.cell(), part)).usable());
  REQUIRE(there.cell() == t.cell());
  return {there.row().begin(), there.row().end()};
}

}  // namespace

TEST_CASE("nothing that play can do is steeper, and something is as steep") {
  std::uint64_t seed = 0;
  for (const GridCoordinates& counts :
       {GridCoordinates{6, 1, 1}, {3, 1, 3}, {3, 2, 3}, {1, 1, 1}, {2, 2, 2}}) {
    const Grid grid = grid_with_force(counts, 2, ++seed);
    const Box& box = grid.box();
    const Oracle oracle(grid);
    double state = 0, force = 0, stiffness = 0, turn = 0;
    for (const auto& [place, t] : oracle.at) {
      Vec3 along{0, 0, 0};
      for (int a = 0; a < 3; ++a)
        for (int i = 0; i < 4 && box.counts[a] > 1; ++i) {
          Vec3 from, to;
          from[(a + 1) % 3] = to[(a + 1) % 3] = i & 1;
          from[(a + 2) % 3] = to[(a + 2) % 3] = i >> 1;
          from[a] = 0;
          to[a] = 1;
          const auto r = row_at(box, t, from), s = row_at(box, t, to);
          state = std::max({state, std::abs(r[0] - s[0]), std::abs(r[1] - s[1])});
          along[a] = std::max(along[a], norm({r[2] - s[2], r[3] - s[3], r[4] - s[4]}) / kSpacing);
        }
      force = std::max({force, along[0], along[1], along[2]});
      stiffness = std::max(stiffness, norm(along));
      // Along an edge the force is linear: its middle gives the work.
      for (int a = 0; a < 3; ++a)
        for (int side = 0; side < 2; ++side) {
          const int u = (a + 1) % 3, v = (a + 2) % 3;
          if (box.counts[u] == 1 || box.counts[v] == 1) continue;
          double work = 0;
          for (int i = 0; i < 2; ++i) {
            Vec3 x;
            x[a] = side;
            x[u] = 0.5, x[v] = i;
            work += (i ? -1 : 1) * row_at(box, t, x)[static_cast<std::size_t>(u) + 2];
            x[u] = i, x[v] = 0.5;
            work += (i ? 1 : -1) * row_at(box, t, x)[static_cast<std::size_t>(v) + 2];
          }
          turn = std::max(turn, std::abs(work) * kSpacing);
        }
    }

    const CellMap map(grid, 1);
    const auto found = find_configurations(grid, map, 1, 1 << 20);
    const Forces forces = stored_forces(grid);
    const Check check = check_steep(grid, map, found, &forces, {}, 2);
    CHECK(check.is_note);
    CHECK(check.found.counted == oracle.at.size());
    // A few roundings of numbers below 2, each way.
    CHECK(figure(check, "state") == Approx(state / kSpacing).epsilon(1e-14));
    CHECK(figure(check, "force") == Approx(force).epsilon(1e-14));
    if (stiffness > 0)
      CHECK(figure(check, "largest stable scale") == Approx(4000 / stiffness).epsilon(1e-14));
    const TrapezoidWork work_of_links(grid, forces);
    const Energy energy = find_energy(grid, work_of_links, 1, 1);
    Check passive = check_passive(grid, work_of_links, energy);
    add_inside_cells(passive, grid, map, found, forces, energy, 2);
    CHECK(figure(passive, "largest turn") == Approx(turn).epsilon(1e-13));
    if (box.points() > 1) CHECK(force > 0);

    // Without forces the states remain.
    const Check states = check_steep(grid, map, found, nullptr, {}, 1);
    CHECK(states.figures.size() == 1);
    CHECK(figure(states, "state") == figure(check, "state"));
    // Two components, compared by the plug-in itself: in which unit is not known.
    CHECK(states.figures[0].unit == "of a component/length");
  }
}

TEST_CASE("a device is stable below K = 2 b f and not above") {
  // A spring of 100 N a length in x, one level: the figures are known.
  GridSpec spec = spec_for({{0, 0, 0}, kSpacing, {4, 3, 3}}, 1);
  spec.stored.force = true;
  RecordColumns columns = random_columns(spec.box, spec.row_size(), 1, 1);
  for (PointIndex p = 0; p < spec.box.points(); ++p) {
    double* row = &columns.rows[p * 4];
    row[0] = row[2] = row[3] = 0;
    row[1] = -100 * spec.box.position(p)[0];
  }
  const Grid grid(spec, 1, columns);
  const CellMap map(grid, 1);
  const Forces forces = stored_forces(grid);
  const auto check = [&](const Rendering& rendering) {
    return check_steep(grid, map, {}, &forces, rendering, 1);
  };
  const Check free = check({});
  CHECK(figure(free, "force") == Approx(100));
  CHECK(figure(free, "force in one branch") == Approx(100));
  CHECK(figure(free, "largest stable scale") == Approx(2 * 2 * 1000 / 100.0));
  CHECK(free.found.offenders == 0);
  const Check stable = check({.damping = 2, .rate_hz = 1000, .scale = 39});
  CHECK(figure(stable, "stiffness") == Approx(100 * 39));
  CHECK(stable.figures.back().where.substr(0, 7) == "stable:");
  CHECK(stable.found.offenders == 0);
  const Check not_stable = check({.damping = 2, .rate_hz = 500, .scale = 39});
  CHECK(not_stable.figures.back().where.substr(0, 11) == "not stable:");
  CHECK(not_stable.found.offenders == not_stable.found.counted);
  CHECK(is_fine({not_stable}));
}
