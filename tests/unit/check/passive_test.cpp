#include "libcore/check/passive.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "libcore/check/energy.hpp"
#include "libcore/check/trapezoid_work.hpp"
#include "tests/unit/check/ball_grid.hpp"
#include "tests/unit/check/oracle.hpp"
#include "tests/unit/haptic/random_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

/// One level at each of n points a side, and a force there.
template <class F>
std::vector<ClosedWalk> gaining(std::uint32_t n, double spacing, F&& force) {
  const Box box{{-1, -1, -1}, spacing, {n, n, n}};
  const Grid grid = random_grid(box, 1, 1, 1);
  std::vector<Vec3> forces;
  for (PointIndex p = 0; p < box.points(); ++p) forces.push_back(force(box.position(p)));
  const Forces all(std::move(forces));
  return find_energy(grid, TrapezoidWork(grid, all), 2, 3).gaining;
}

/// Whether a closed walk gains more than it is allowed, by Floyd and Warshall.
bool can_gain(const Grid& grid, const Work& work, double rate = 0) {
  const std::size_t n = grid.records();
  std::vector<double> cost(n * n, std::numeric_limits<double>::infinity());
  for (RecordIndex r = 0; r < n; ++r)
    for (int q = 0; q < kDirections; ++q) {
      const RecordIndex t = grid.destination(r, q);
      if (t != Grid::kNoRecord)
        cost[r * n + t] =
            std::min(cost[r * n + t],
                     work.allowance({r, q}) + rate * work.length({r, q}) - work.gain({r, q}));
    }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        cost[i * n + j] = std::min(cost[i * n + j], cost[i * n + k] + cost[k * n + j]);
  for (std::size_t i = 0; i < n; ++i)
    if (cost[i * n + i] < -1e-9) return true;
  return false;
}

/// The records along y = z = 0 from the left end to the right one and back, as links.
std::vector<Link> there_and_back(const Grid& grid) {
  std::vector<Link> links;
  RecordIndex r = 0;
  for (const int d : {1, -1}) {
    const int q = Direction::of(d, 0, 0).q();
    for (RecordIndex to; (to = grid.destination(r, q)) != Grid::kNoRecord; r = to)
      links.push_back({r, q});
  }
  CHECK(r == 0);
  return links;
}

struct Sum {
  double gain = 0, bound = 0;
};
Sum sum_of(const TrapezoidWork& work, const std::vector<Link>& links) {
  Sum sum;
  for (const Link& link : links) {
    sum.gain += work.gain(link);
    sum.bound += work.bound(link);
  }
  return sum;
}

Forces forces_of(const Grid& grid) {
  const auto make = [&] { return hung_ball::make(grid.spec().parameters); };
  return Forces(record_fields(grid, make, 2).force);
}
Forces turned(const Grid& grid, const Forces& forces) {
  std::vector<Vec3> all;
  for (RecordIndex r = 0; r < grid.records(); ++r)
    all.push_back({-forces[r][0], -forces[r][1], -forces[r][2]});
  return Forces(std::move(all));
}

const Box kBallBox{{-0.975, -0.475, -0.475}, 0.05, {40, 20, 20}};
// A force that is cut has no energy.
const std::vector<Parameter> kUncut{{"max_force", 1e6}};

void require_closed(const Grid& grid, const TrapezoidWork& work, const ClosedWalk& walk) {
  REQUIRE_FALSE(walk.links.empty());
  for (std::size_t i = 0; i < walk.links.size(); ++i)
    REQUIRE(grid.destination(walk.links[i].from, walk.links[i].q) ==
            walk.links[(i + 1) % walk.links.size()].from);
  const Sum sum = sum_of(work, walk.links);
  CHECK(walk.gain == Approx(sum.gain));
  CHECK(walk.allowance == Approx(4 * sum.bound));
  CHECK(walk.gain > walk.allowance);
}

}  // namespace

TEST_CASE("the gradient of an energy gives nothing back") {
  CHECK(gaining(8, 0.25, [](const Vec3&) { return Vec3{3, -2, 0.1}; }).empty());
  CHECK(gaining(8, 0.25, [](const Vec3& x) { return Vec3{-50 * x[0], 7 * x[1], x[2]}; }).empty());
  // E = sin(2x) cos(3y) exp(z)
  CHECK(gaining(8, 0.25, [](const Vec3& x) {
          const double e = std::exp(x[2]);
          return Vec3{-2 * std::cos(2 * x[0]) * std::cos(3 * x[1]) * e,
                      3 * std::sin(2 * x[0]) * std::sin(3 * x[1]) * e,
                      -std::sin(2 * x[0]) * std::cos(3 * x[1]) * e};
        }).empty());
  // A wall, and a ball with a hole: kinks and jumps anywhere in a link.
  CHECK(gaining(9, 0.25, [](const Vec3& x) {
          return Vec3{0, x[1] > 0.1 ? -30 * (x[1] - 0.1) : 0, 0};
        }).empty());
  CHECK(gaining(9, 0.25, [](const Vec3& x) {
          const double r = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
          if (r < 0.3 || r > 0.8) return Vec3{0, 0, 0};
          const double f = 20 * (0.8 - r) / r;
          return Vec3{f * x[0], f * x[1], f * x[2]};
        }).empty());
}

TEST_CASE("a force that turns about an axis is found") {
  const Box box{{-1, -1, -1}, 0.25, {8, 8, 8}};
  const Grid grid = random_grid(box, 1, 1, 1);
  std::vector<Vec3> forces;
  for (PointIndex p = 0; p < box.points(); ++p) {
    const Vec3 x = box.position(p);
    // On top of a spring; a linear force needs no allowance but the noise.
    forces.push_back({-5 * x[0] - 0.01 * x[1], 0.01 * x[0] - 5 * x[1], -5 * x[2]});
  }
  const Forces all(std::move(forces));
  const TrapezoidWork work(grid, all);
  const Energy energy = find_energy(grid, work, 2, 3);
  REQUIRE(energy.gaining.size() == 3);
  CHECK_FALSE(energy.gave_up);
  for (const ClosedWalk& walk : energy.gaining) {
    require_closed(grid, work, walk);
    // Twice the curl's half times the area of the walk in the plane: whole triangles of h²/2.
    const double triangles = walk.gain / (0.01 * 0.25 * 0.25);
    CHECK(triangles == Approx(std::round(triangles)).margin(1e-6));
    CHECK(triangles > 0.5);
  }
  const CellMap map(grid, 1);
  Check check = check_passive(grid, work, energy);
  CHECK(check.verdict() == "broken");
  CHECK(check.found.offenders == 3);
  // The curl, 0.02, times the area of a walk, by its length. Links at the box's sides have
  // allowances: the square beside them is a walk, and no curve in the whole box encloses more for
  // its length than its side by 2 + sqrt(pi) (its Cheeger set).
  CHECK(figure(check, "gain per length") > 0.02 * 1.25 / 4);
  CHECK(figure(check, "gain per length") < 0.02 * 1.75 / (2 + std::sqrt(3.15)));
  add_inside_cells(check, grid, map, {}, all, energy, 2);
  CHECK(figure(check, "largest turn") == Approx(2 * 0.01 * 0.25 * 0.25));
}

TEST_CASE("a closed walk that gains is found exactly where there is one") {
  std::mt19937_64 random(4);
  int with = 0, without = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Box box{{0, 0, 0}, 0.5, {5, 1 + static_cast<std::uint32_t>(random() % 3), 5}};
    const Grid grid = random_grid(box, 1, 1 + trial % 3, random());
    const double noise = std::pow(10, uniform(random, -4, 0));
    const double turning = std::pow(10, uniform(random, -3, 0));
    std::vector<Vec3> forces;
    for (RecordIndex r = 0; r < grid.records(); ++r) {
      const Vec3 x = box.position(grid.point(r));
      Vec3 f{-x[0] + turning * x[2], -x[1], -2 * x[2] - turning * x[0]};
      for (double& component : f) component += noise * uniform(random, -1, 1);
      forces.push_back(f);
    }
    const Forces all(std::move(forces));
    const TrapezoidWork work(grid, all);
    const Energy energy = find_energy(grid, work, 1 + trial % 2, 1);
    const bool can = can_gain(grid, work);
    CHECK(energy.gaining.empty() != can);
    for (const ClosedWalk& walk : energy.gaining) require_closed(grid, work, walk);
    // No walk is steeper than the steepest one, which is as steep as it says.
    REQUIRE(energy.is_steepest);
    const double rate = energy.steepest.rate();
    CHECK((rate > 0) == can);
    CHECK_FALSE(can_gain(grid, work, rate + 1e-8));
    if (can) require_closed(grid, work, energy.steepest);
    CHECK(find_energy(grid, work, 1, 1, rate * (1 + 1e-9)).gaining.empty());
    CHECK(find_energy(grid, work, 1, 1, rate / 2).gaining.empty() == !can);
    ++(can ? with : without);
  }
  CHECK(with > 5);
  CHECK(without > 5);
}

TEST_CASE("the hung ball's loop costs what the ball drops by") {
  // On the line y = z = 0 the ball is torn off where HIP, ball and hinge are in line: the rope is
  // then at cos α = 1 / (1 + 2r), on either side.
  const double drop = 1 - 1 / (1 + 2 * hung_ball::kRadius);
  const Grid grid = hung_ball::grid({{-0.9, 0, 0}, 1.8 / 16000, {16001, 1, 1}}, kUncut);
  const Forces forces = forces_of(grid);
  const TrapezoidWork work(grid, forces);
  const auto loop = there_and_back(grid);
  CHECK(loop.size() == 32000);
  const Sum sum = sum_of(work, loop);
  CHECK(std::abs(sum.gain + 2 * drop) <= sum.bound);
  CHECK(sum.bound < 0.25 * drop);

  const Energy energy = find_energy(grid, work, 2, 1);
  CHECK(energy.gaining.empty());
  const Check check = check_passive(grid, work, energy);
  CHECK(check.verdict() == "ok");
  CHECK(check.found.counted == 2 * (grid.records() - 1));
  // A force of the wrong sign returns it.
  const Forces wrong = turned(grid, forces);
  const TrapezoidWork wrong_work(grid, wrong);
  const Energy returned = find_energy(grid, wrong_work, 2, 1);
  REQUIRE(returned.gaining.size() == 1);
  require_closed(grid, wrong_work, returned.gaining[0]);
  CHECK(returned.gaining[0].gain == Approx(2 * drop).margin(sum.bound));
}

TEST_CASE("a ball that falls loses what it drops by") {
  // In the plane z = 0 the HIP gets round the ball, so that its potential is one: on the line y = 0
  // the last link before the ball is torn off loses the drop.
  const double drop = 1 - 1 / (1 + 2 * hung_ball::kRadius);
  const Grid grid = hung_ball::grid({{-0.9, -0.3, 0}, 0.0125, {145, 49, 1}}, kUncut);
  const Forces forces = forces_of(grid);
  const TrapezoidWork work(grid, forces);
  const Energy energy = find_energy(grid, work, 2, 1);
  CHECK(energy.gaining.empty());
  const int right = Direction::of(1, 0, 0).q();
  double bound = 0;
  RecordIndex r = grid.first(grid.box().index({0, 24, 0}));
  for (; work.is_reversible({r, right}); r = grid.destination(r, right))
    bound += work.bound({r, right});
  const RecordIndex fallen = grid.destination(r, right);
  CHECK(grid.state(r)[0] > 0.5);
  REQUIRE(grid.state(fallen)[0] == 0);
  REQUIRE(energy.part[r] == energy.part[fallen]);
  const double loss = energy.potential[r] - energy.potential[fallen] - work.gain({r, right});
  bound += work.bound({r, right});
  // The way there is off by its bound at most, and so may be the way that the potential took.
  CHECK(std::abs(loss - drop) <= 2 * bound);
  CHECK(bound < drop);
  CHECK(figure(check_passive(grid, work, energy), "largest loss") >= loss);
}

TEST_CASE("a mixture of branches that the hand carries along returns energy, as much as is said") {
  // Beside the ball: at y = 0.175 it is touched, at 0.225 it is not. Between, play has a cell of
  // both, and keeps each corner's branch on the way along x: to where the ball is high without
  // touching it, in to the touched side, and back down with it.
  const Grid grid = hung_ball::grid(kBallBox, kUncut);
  const Forces forces = forces_of(grid);
  const double touched = 0.1751, free = 0.2249, low = -0.05, high = 0.2;
  PaperTraversal t(grid);
  double gain = 0;
  Vec3 last;
  const auto force_here = [&] {  // as play interpolates one that is stored
    Vec3 xbar, force{0, 0, 0};
    for (int a = 0; a < 3; ++a)
      xbar[a] = (t.position()[a] - kBallBox.position(t.cell())[a]) / kBallBox.spacing;
    const auto w = corner_weights(xbar);
    for (int corner = 0; corner < 8; ++corner)
      for (int a = 0; a < 3; ++a) force[a] += w[corner] * forces[t.records()[corner]][a];
    return force;
  };
  const auto go = [&](double x, double y) {
    const Vec3 from = t.position();
    for (int k = 1; k <= 1000; ++k) {
      const Vec3 to{from[0] + (x - from[0]) * k / 1000, from[1] + (y - from[1]) * k / 1000, 0};
      const Vec3 before = t.position();
      REQUIRE(t.step(to).usable());
      const Vec3 force = force_here();
      for (int a = 0; a < 3; ++a) gain += (last[a] + force[a]) / 2 * (to[a] - before[a]);
      last = force;
    }
  };
  t.start({-0.7, touched, 0});
  last = force_here();
  go(low, touched);
  const auto start = t.records();
  std::vector<double> loops;
  for (int loop = 0; loop < 3; ++loop) {
    gain = 0;
    go(low, free);
    go(high, free);
    go(high, touched);
    go(low, touched);
    CHECK(t.records() == start);
    loops.push_back(gain);
  }
  const CellMap map(grid, 2);
  const auto found = find_configurations(grid, map, 2, 1 << 20);
  const TrapezoidWork work(grid, forces);
  const Energy energy = find_energy(grid, work, 2, 1);
  Check check = check_passive(grid, work, energy);
  add_inside_cells(check, grid, map, found, forces, energy, 2);
  CHECK(check.verdict() == "ok");  // no walk along links does that
  for (const double loop : loops) {
    CHECK(loop == Approx(loops[0]));
    CHECK(loop > 0.01);
    CHECK(loop < figure(check, "largest mixture"));
  }
}

TEST_CASE(
    "the ball in its box loses; with a force of the wrong sign, or links exchanged, it gains") {
  const Grid grid = hung_ball::grid(kBallBox, kUncut);
  CHECK(grid.records() == 18104);  // as seed and expand find them, examples/hung-ball
  const Forces forces = forces_of(grid);
  CHECK(find_energy(grid, TrapezoidWork(grid, forces), 2, 1).gaining.empty());
  const Forces wrong = turned(grid, forces);
  const TrapezoidWork wrong_work(grid, wrong);
  const Energy returned = find_energy(grid, wrong_work, 2, 1);
  REQUIRE(returned.gaining.size() == 1);
  require_closed(grid, wrong_work, returned.gaining[0]);

  // Where the ball is pushed highest near y = z = 0, the links to the right of the two levels are
  // exchanged: the one that hangs free is then lifted for nothing.
  RecordColumns columns;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    columns.point.push_back(grid.point(r));
    columns.level.push_back(grid.level(r));
    columns.generation.push_back(0);
    columns.rows.push_back(grid.state(r)[0]);
    columns.links.insert(columns.links.end(), grid.links(r).begin(), grid.links(r).end());
  }
  const PointIndex p = kBallBox.index({29, 10, 9});  // x = 0.475
  REQUIRE(grid.levels(p) == 2);
  const auto q = static_cast<std::size_t>(Direction::of(1, 0, 0).q());
  std::swap(columns.links[grid.first(p) * kDirections + q],
            columns.links[(grid.first(p) + 1) * kDirections + q]);
  const Grid exchanged(grid.spec(), 1, columns);
  const TrapezoidWork work(exchanged, forces);
  const Energy energy = find_energy(exchanged, work, 2, 1);
  REQUIRE(energy.gaining.size() == 1);
  require_closed(exchanged, work, energy.gaining[0]);
  CHECK(std::any_of(energy.gaining[0].links.begin(), energy.gaining[0].links.end(),
                    [&](const Link& link) {
                      return exchanged.point(link.from) == p && link.q == static_cast<int>(q);
                    }));
}
