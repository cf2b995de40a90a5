// Whether the force that play sends gives energy back (libcore/check/played_work.hpp).
#include "libcore/check/played_work.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "libcore/check/passive.hpp"
#include "libcore/check/trapezoid_work.hpp"
#include "tests/unit/check/ball_grid.hpp"
#include "tests/unit/check/oracle.hpp"
#include "tests/unit/haptic/random_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

const Box kBallBox{{-0.975, -0.475, -0.475}, 0.05, {40, 20, 20}};

/// A grid of one branch, and the force of its records as play interpolates it.
struct Played {
  Grid grid;
  BranchMap map;
  NodeEnergies nodes;

  template <class F>
  Played(const Box& box, F&& force)
      : grid(random_grid(box, 1, 1, 1)), map(grid), nodes(grid, &map.sheets, fields(force)) {}

  PlayedWork work(const ForceLimit& limit = {}) const {
    return {grid, map, nodes, mean_force, limit, 2};
  }

 private:
  template <class F>
  RecordFields fields(F&& force) const {
    RecordFields all;
    for (RecordIndex r = 0; r < grid.records(); ++r)
      all.force.push_back(force(grid.box().position(grid.point(r))));
    return all;
  }
};

}  // namespace

TEST_CASE("a swirl under a ripple is found where the force is known between the points") {
  // 2 N around the z axis, and 0.7 N that change from point to point: allowances for a field that
  // nobody knows between the points hide the swirl.
  const Box box{{-1, -1, -1}, 0.25, {9, 9, 5}};
  std::mt19937_64 random(9);
  const Played played(box, [&](const Vec3& x) {
    const double r = std::max(0.1, std::hypot(x[0], x[1]));
    Vec3 f{-2 * x[1] / r, 2 * x[0] / r, 0};
    for (double& component : f) component += uniform(random, -0.7, 0.7);
    return f;
  });
  const Energy energy = find_energy(played.grid, played.work(), 2, 3, 0.2);
  CHECK(check_passive(played.grid, played.work(), energy).verdict() == "broken");
  // On the square around the axis the force along the way is 2 N times the cosine of at most 45
  // degrees, and the ripple's mean is small.
  CHECK(energy.steepest.rate() > 1.2);
  CHECK(energy.steepest.rate() < 2.7);
}

TEST_CASE("the work along a link is the integral of the played force") {
  const Box box{{0, 0, 0}, 0.5, {4, 3, 3}};
  const Played played(box, [](const Vec3& x) {
    return Vec3{3 * x[0] - x[1], 2 - 5 * x[2] * x[0], x[1] * x[1]};
  });
  for (const double max_force : {1e9, 2.5}) {
    const ForceLimit limit{1.5, max_force};
    const PlayedWork work = played.work(limit);
    for (RecordIndex r = 0; r < played.grid.records(); ++r)
      for (int q = 0; q < kDirections; ++q) {
        const RecordIndex to = played.grid.destination(r, q);
        if (to == Grid::kNoRecord || !work.takes(q)) continue;
        // By midpoints of a thousand parts, of the linear force between the two records.
        const Vec3 d = played.grid.neighbourhood().shift(q);
        double sum = 0;
        for (int i = 0; i < 1000; ++i) {
          Vec3 f;
          const double u = (i + 0.5) / 1000;
          for (int a = 0; a < 3; ++a)
            f[a] = -(1 - u) * played.nodes[r].slope[a] - u * played.nodes[to].slope[a];
          f = limit(f);
          sum += (f[0] * d[0] + f[1] * d[1] + f[2] * d[2]) / 1000;
        }
        // A kink moves Gauss's two points off by at most a piece of 1/16, and the force changes by
        // at most 1.5 * 6 N along a link of 0.5.
        CHECK(work.gain({r, q}) == Approx(sum).margin(max_force > 1e6 ? 1e-6 : 0.01));
        CHECK(work.gain({to, Direction(q).opposite().q()}) ==
              Approx(-work.gain({r, q})).margin(1e-9));
      }
  }
}

TEST_CASE("a limit that keeps the direction makes a gradient gain") {
  // Of E = 5 x² + y² / 2, far from its axis: where it is cut to a length, its curl is not 0.
  const Box box{{-1, -1, 0}, 0.125, {17, 17, 1}};
  const Played played(box, [](const Vec3& x) { return Vec3{-10 * x[0], -x[1], 0}; });
  const Energy whole = find_energy(played.grid, played.work(), 2, 1, 1e-4);
  CHECK(whole.gaining.empty());
  const ForceLimit limit{1, 2};
  const Energy cut = find_energy(played.grid, played.work(limit), 2, 1, 1e-4);
  CHECK(cut.steepest.rate() > 0.1);
  const Check check = check_limited(played.grid, limit, cut);
  CHECK(check.verdict() == "note");
  CHECK(figure(check, "gain per length") == cut.steepest.rate());
}

TEST_CASE("work that is not finite is broken") {
  const Box box{{0, 0, 0}, 1, {3, 3, 3}};
  const Grid grid = random_grid(box, 1, 1, 1);
  std::vector<Vec3> forces(grid.records(), Vec3{0, 0, 0});
  forces[13] = {1e308, 1e308, 1e308};
  forces[14] = {1e308, 1e308, 1e308};
  const Forces all(std::move(forces));
  const TrapezoidWork work(grid, all);
  const Check check = check_passive(grid, work, find_energy(grid, work, 1, 1));
  CHECK(check.verdict() == "broken");
}

TEST_CASE("the hung ball's snaps lead down, also where a finer grid meets its cusp") {
  // The finer one has points in the plane x = 0, where the two sides of the ball meet.
  for (const Box& box : {kBallBox, Box{{-0.9875, -0.4875, -0.4875}, 0.025, {80, 40, 40}}}) {
    const Grid grid = hung_ball::grid(box, {});
    const RecordFields fields = record_fields(
        grid, [&] { return hung_ball::make(grid.spec().parameters); }, 2);
    const BranchMap map(grid);
    const NodeEnergies nodes(grid, &map.sheets, fields);
    const PlayedWork work(grid, map, nodes, hermite_force, {}, 2);
    const Energy energy = find_energy(grid, work, 2, 3, 0.2);
    CHECK(check_passive(grid, work, energy).verdict() == "ok");
  }
}
