// The model beside the grid: whom the state follows when the grid and the model disagree.
#include "libcore/follow/beside.hpp"

#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/node_force.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"
#include "tests/unit/follow/line_models.hpp"
#include "tests/unit/follow/places.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

/// The places of a hand that goes there and back, 200 ticks a spacing.
std::vector<Vec3> there_and_back() {
  std::vector<Vec3> path;
  for (int i = 50; i <= 1350; ++i) path.push_back({i / 200.0, 0, 0});
  for (int i = 1350; i >= 50; --i) path.push_back({i / 200.0, 0, 0});
  return path;
}

/// How many ticks the state is not the model's, and that it is one of a branch in all ticks.
int ticks_apart(const Grid& grid, double ends, std::optional<std::uint32_t> delay) {
  BranchTraversal t(grid, std::make_shared<const BranchNodes>(grid));
  std::optional<Beside> beside;
  if (delay) {
    beside.emplace(grid, model_of_line(grid.spec(), ends), *delay);
    beside->begin(1000);
    t.walk_beside(&*beside);
  }
  bool upper = true;
  int apart = 0;
  for (const Vec3& x : there_and_back()) {
    upper = upper ? x[0] <= ends : x[0] < kComesBack;
    REQUIRE(t.step(x).usable());
    const double state = t.state()[0];
    // States are linear on a branch, so that even the ghosts are exact: some roundings of 100.
    const bool on_upper = std::abs(state - state_at(true, x[0])) < 1e-12;
    REQUIRE((on_upper || state == -100));
    apart += on_upper != upper;
  }
  return apart;
}

}  // namespace

TEST_CASE("where the grid and the model disagree on a snap, the state follows the model") {
  const Grid grid = line();
  // Alone the grid is wrong between 4.5 and the true end, and between 2.5 and 2.6, with 200 ticks a
  // spacing; a tick at each end can count or not.
  CHECK(std::abs(ticks_apart(grid, kEndsLate, std::nullopt) - (80 + 20)) <= 2);
  CHECK(std::abs(ticks_apart(grid, kEndsEarly, std::nullopt) - (40 + 20)) <= 2);
  // Play hears some ticks later what the model said, but the model looked so far ahead. A tick at
  // each snap can count or not.
  for (const std::uint32_t delay : {1U, 5U, 21U}) {
    CHECK(ticks_apart(grid, kEndsEarly, delay) <= 2);
    CHECK(ticks_apart(grid, kEndsLate, delay) <= 2);
  }
}

TEST_CASE("the state and the force are the model's, and fade to the grid's when it fails") {
  const Grid grid = straight_line();
  const double fails_at = 4.3;
  // To and fro between points, and from 2 s on beyond the place where the model fails.
  std::vector<double> path;
  path.reserve(1000);
  for (int i = 0; i < 400; ++i) path.push_back(2.7 + 1.5 * std::sin(i / 50.0));
  while (path.back() < 5.5) path.push_back(path.back() + 0.01);
  WalkBeside walk(grid, wavy_model(grid.spec(), fails_at), 1);
  auto& [t, beside] = walk;
  RecordFields fields;
  for (int i = 0; i < 8; ++i) fields.force.push_back({-i / 10.0, 0, 0});
  NodeForce force(std::make_shared<const NodeEnergies>(node_energies(grid, fields)), grid.box(),
                  mean_force);
  // An answer is a tick late and looks ahead to where the hand is, but for the bend of its way, 1.5
  // / 50^2 at most. The wave is steepest where it is 0. In the first tick there is none.
  const double off = 1e-12 + 1.5 / 2500 * 2 * std::numbers::pi * kWave;
  // So far both move in a tick of at most 0.03, and what they lack fades within half a spacing.
  const double most = 0.03 * (1 + 2 * std::numbers::pi * kWave + kWave / 0.5);
  double before = path[0] + wave(path[0]), force_before = -path[0] / 10 + wave(path[0]);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double x = path[i];
    REQUIRE(t.step({x, 0, 0}).usable());
    const double state = t.state()[0], f = force(t)[0];
    if (i > 1) {
      CHECK(std::abs(state - before) < most);
      CHECK(std::abs(f - force_before) < most);
    }
    before = state, force_before = f;
    const bool has_failed = x >= fails_at + 0.51;
    // Answers begin after the start: what the grid lacks comes within half a spacing. In tick 400
    // the hand changes its speed at once.
    if (i > 40 && i != 400 && (x < fails_at - 0.05 || has_failed)) {
      const double lacks = has_failed ? 0 : wave(x);
      CHECK(std::abs(state - x - lacks) <= off);
      CHECK(std::abs(f + x / 10 - lacks) <= off + 1e-6);  // the grid's forces are floats
    }
  }
}

TEST_CASE("a hand that turns round before it comes to where the model looked ahead stays") {
  const Grid grid = line();
  constexpr int kLate = 5;
  WalkBeside walk(grid, model_of_line(grid.spec(), kEndsEarly), kLate);
  auto& [t, beside] = walk;
  // 200 ticks a spacing: it turns 4 ticks before the end of the branch.
  constexpr int kTurn = static_cast<int>(kEndsEarly * 200) - 4;
  int apart = 0;
  for (int i = 50; i <= 2 * kTurn - 50; ++i) {
    const double x = (i <= kTurn ? i : 2 * kTurn - i) / 200.0;
    REQUIRE(t.step({x, 0, 0}).usable());
    const bool is_upper = std::abs(t.state()[0] - state_at(true, x)) < 1e-12;
    apart += !is_upper;
    // Answers that look ahead beyond the end come until the turn is as old as they are.
    if (std::abs(i - kTurn) > kLate + 1) REQUIRE(is_upper);
  }
  CHECK(apart <= 2 * kLate);
}

TEST_CASE("a hand that turns round gets what the model said of the places on its way") {
  const Grid grid = straight_line();
  WalkBeside walk(grid, wavy_model(grid.spec(), 8), 5);
  auto& [t, beside] = walk;
  for (int i = 0; i < 800; ++i) {
    const double x = (i < 400 ? i : 800 - i) / 100.0 + 0.5;
    REQUIRE(t.step({x, 0, 0}).usable());
    // The wave is steepest where the hand turns, and the nearest answer is of a place two ticks
    // away. The newest one is of a place beyond the turn, up to ten ticks away.
    if (i > 60) CHECK(std::abs(t.state()[0] - x - wave(x)) <= 2 * std::numbers::pi * kWave * 0.021);
  }
}

TEST_CASE("an answer is about where the hand is when it comes, if the hand goes straight on") {
  const Grid grid = line();
  Beside beside(grid, model_of_line(grid.spec(), kEndsLate), 3);
  beside.begin(1000);
  beside.start({1, 0, 0});
  for (int i = 1; i <= 40; ++i) beside.follow({1 + i / 100.0, 0, 0});
  beside.receive();
  REQUIRE(beside.answer());
  CHECK(beside.answer()->tick == 42 - 3);
  CHECK(beside.answer()->at[0] == Approx(1.41).epsilon(1e-12));  // some roundings
  CHECK(beside.answer()->row[0] == Approx(11.41).epsilon(1e-12));
}

TEST_CASE(
    "an answer counts by its way: as long as its place is within half a spacing of the hand") {
  const Grid grid = line();
  // So late that the model does not look ahead: 100 ticks are half a spacing.
  CHECK(ticks_apart(grid, kEndsLate, 101) == ticks_apart(grid, kEndsLate, std::nullopt));
  Beside beside(grid, model_of_line(grid.spec(), kEndsLate), 20);
  beside.begin(1000);
  beside.start({1, 0, 0});
  for (int i = 1; i < 20; ++i) {
    beside.receive();
    CHECK(beside.answer() == nullptr);
    beside.follow({1 + i / 100.0, 0, 0});
  }
  beside.receive();
  REQUIRE(beside.answer());
  CHECK(beside.answer()->tick == 1);
  CHECK(beside.answer()->at == Vec3{1, 0, 0});
  CHECK(beside.answer()->row[0] == 11);
  CHECK(beside.kept_up() == 1);
  CHECK(beside.lateness().max() == 20);
  // The model starts anew with the hand, so that no older answer counts.
  beside.start({2, 0, 0});
  CHECK(beside.answer() == nullptr);
}

TEST_CASE("a model that cannot convert a state leaves the decision to the grid") {
  const Grid grid = line();
  WalkBeside walk(grid,
                  std::make_unique<tiny::TestModel>(
                      grid.spec(), [](const double*, const Vec3&, const Vec3&, double*,
                                      std::string& error) { return error = "no", false; }),
                  1);
  auto& [t, beside] = walk;
  BranchTraversal alone(grid, std::make_shared<const BranchNodes>(grid));
  for (const Vec3& x : there_and_back()) {
    REQUIRE(t.step(x).usable());
    alone.step(x);
    REQUIRE(copy(t.state()) == copy(alone.state()));
  }
  CHECK(beside.kept_up() <= 2);  // at grid points, where play starts without a conversion
}

TEST_CASE("with a model beside the grid no step allocates, whatever model and links say") {
  const Box box{{0, 0, 0}, 1, {8, 7, 6}};
  const Grid grid = random_grid(box, 3, 4, 3);
  BranchTraversal t(grid, std::make_shared<const BranchNodes>(grid));
  std::mt19937_64 random(3);
  Beside beside(grid,
                std::make_unique<tiny::TestModel>(
                    grid.spec(),
                    [&](const double*, const Vec3&, const Vec3&, double* row, std::string&) {
                      for (int c = 0; c < 3; ++c) row[c] = uniform(random, -1, 1);
                      return random() % 8 != 0;
                    }),
                2);
  beside.begin(1000);
  t.walk_beside(&beside);
  std::vector<Vec3> path;
  for (int leg = 0; leg < 100; ++leg) {
    const Vec3 from = random_point(box, random), to = random_point(box, random);
    for (int i = 0; i < 40; ++i) path.push_back(from + i / 40.0 * (to - from));
  }
  const std::uint64_t before = allocations();
  bool usable = true;
  for (const Vec3& x : path) usable &= t.step(x).usable();
  CHECK(allocations() == before);
  CHECK(usable);
  CHECK(beside.kept_up() > 0);
}
