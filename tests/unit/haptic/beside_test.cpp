// The model beside the grid: whom the state follows when the grid and the model disagree, and that
// the loop never waits.
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "libcore/haptic/branch_traversal.hpp"
#include "libcore/haptic/node_force.hpp"
#include "libcore/model/process_model.hpp"
#include "tests/unit/check/tiny_grid.hpp"
#include "tests/unit/haptic/count_allocations.hpp"
#include "tests/unit/haptic/places.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

// Where the model's upper branch ends, before and behind the place where the grid says so, and
// where it comes back, before that place.
constexpr double kEndsEarly = 4.3, kEndsLate = 4.9, kComesBack = 2.6;

/// Along a line: 10 + x on the upper branch, -100 on the lower one.
double state_at(bool upper, double x) { return upper ? 10 + x : -100; }

/// The grid says that the upper branch ends at 4.5, the middle of a link, and comes back at 2.5.
Grid line() {
  const Box box{{0, 0, 0}, 1, {8, 1, 1}};
  RecordColumns columns;
  for (int i = 0; i < 8; ++i)
    for (const bool upper : {true, false}) {
      if (upper ? i > 4 : i < 3) continue;
      const Level left = i == 0 ? kLeavesBox : !upper && i >= 4 && i <= 5;
      const Level right = i == 7 ? kLeavesBox : !upper && i < 4;
      tiny::add(columns, static_cast<PointIndex>(i), !upper && i <= 4, 0, state_at(upper, i), left,
                right);
    }
  return Grid(spec_for(box, 1), 1, columns);
}

std::unique_ptr<Model> model_of_line(const GridSpec& spec, double ends, int pause_us = 0) {
  return std::make_unique<tiny::TestModel>(
      spec, [=](const double* s, const Vec3& x, const Vec3& d, double* row, std::string&) {
        if (pause_us > 0) std::this_thread::sleep_for(std::chrono::microseconds(pause_us));
        const double to = x[0] + d[0];
        *row = state_at(*s > 0 ? to <= ends : to < kComesBack, to);
        return true;
      });
}

/// The places of a hand that goes there and back, 200 ticks a spacing.
std::vector<Vec3> there_and_back() {
  std::vector<Vec3> path;
  for (int i = 50; i <= 1350; ++i) path.push_back({i / 200.0, 0, 0});
  for (int i = 1350; i >= 50; --i) path.push_back({i / 200.0, 0, 0});
  return path;
}

/// How many ticks the state is not the model's, and that it is one of a branch in all ticks.
int ticks_apart(const Grid& grid, double ends, std::optional<std::uint32_t> delay) {
  BranchTraversal t(grid, std::make_shared<const BranchMap>(grid));
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
  CHECK(ticks_apart(grid, kEndsLate, 0) == 0);
  CHECK(ticks_apart(grid, kEndsEarly, 0) == 0);
  // Play hears 5 ticks later what the model said, but the model looked so far ahead. A tick at each
  // snap can count or not.
  CHECK(ticks_apart(grid, kEndsEarly, 5) <= 2);
  CHECK(ticks_apart(grid, kEndsLate, 5) <= 2);
}

// Between the points of a grid that stores forces, this model's state and force differ from what is
// interpolated.
constexpr double kWave = 0.05;

double wave(double x) { return kWave * std::sin(2 * std::numbers::pi * x); }

/// One branch: state and force along x are linear, but for the wave.
Grid straight_line() {
  const Box box{{0, 0, 0}, 1, {8, 1, 1}};
  GridSpec spec = spec_for(box, 1);
  spec.tolerance = 4 * kWave;
  spec.stored.force = true;
  RecordColumns columns;
  for (int i = 0; i < 8; ++i) {
    tiny::add(columns, static_cast<PointIndex>(i), 0, 0, i, i == 0 ? kLeavesBox : 0,
              i == 7 ? kLeavesBox : 0);
    columns.rows.insert(columns.rows.end(), {-i / 10.0, 0, 0});
  }
  return Grid(spec, 1, columns);
}

/// It fails beyond a place.
std::unique_ptr<Model> wavy_model(const GridSpec& spec, double fails_at) {
  return std::make_unique<tiny::TestModel>(
      spec, [=](const double*, const Vec3& x, const Vec3& d, double* row, std::string& error) {
        const double to = x[0] + d[0];
        std::fill_n(row, 4, 0.0);
        row[0] = to + wave(to);
        row[1] = -to / 10 + wave(to);
        return to < fails_at || (error = "no", false);
      });
}

TEST_CASE("the state and the force are the model's, and fade to the grid's when it fails") {
  const Grid grid = straight_line();
  const double fails_at = 4.3;
  // To and fro between points, and from 2 s on beyond the place where the model fails.
  std::vector<double> path;
  path.reserve(1000);
  for (int i = 0; i < 400; ++i) path.push_back(2.7 + 1.5 * std::sin(i / 50.0));
  while (path.back() < 5.5) path.push_back(path.back() + 0.01);
  for (const std::uint32_t delay : {0U, 1U}) {
    Beside beside(grid, wavy_model(grid.spec(), fails_at), delay);
    beside.begin(1000);
    BranchTraversal t(grid, std::make_shared<const BranchMap>(grid));
    t.walk_beside(&beside);
    RecordFields fields;
    for (int i = 0; i < 8; ++i) fields.force.push_back({-i / 10.0, 0, 0});
    NodeForce force(std::make_shared<const NodeEnergies>(grid, fields), grid.box(), mean_force);
    // An answer that is late looks ahead to where the hand is, but for the bend of its way, 1.5 /
    // 50^2 at most. The wave is steepest where it is 0. In the first tick there is none.
    const double off = delay == 0 ? 1e-12 : 1e-12 + 1.5 / 2500 * 2 * std::numbers::pi * kWave;
    // So far both move in a tick of at most 0.03, and what they lack fades within half a spacing.
    const double most = 0.03 * (1 + 2 * std::numbers::pi * kWave + kWave / 0.5);
    double before = path[0] + wave(path[0]), force_before = -path[0] / 10 + wave(path[0]);
    for (std::size_t i = 0; i < path.size(); ++i) {
      const double x = path[i];
      REQUIRE(t.step({x, 0, 0}).usable());
      const double state = t.state()[0], f = force(t)[0];
      if (i > delay) {
        CHECK(std::abs(state - before) < most);
        CHECK(std::abs(f - force_before) < most);
      }
      before = state, force_before = f;
      const bool has_failed = x >= fails_at + 0.51;
      // Late answers begin after the start: what the grid lacks comes within half a spacing. In
      // tick 400 the hand changes its speed at once.
      if (i > 40 && i != 400 && (x < fails_at - 0.05 || has_failed)) {
        const double lacks = has_failed ? 0 : wave(x);
        CHECK(std::abs(state - x - lacks) <= off);
        CHECK(std::abs(f + x / 10 - lacks) <= off + 1e-6);  // the grid's forces are floats
      }
    }
  }
}

TEST_CASE("a hand that turns round before it comes to where the model looked ahead stays") {
  const Grid grid = line();
  BranchTraversal t(grid, std::make_shared<const BranchMap>(grid));
  constexpr int kLate = 5;
  Beside beside(grid, model_of_line(grid.spec(), kEndsEarly), kLate);
  beside.begin(1000);
  t.walk_beside(&beside);
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
  BranchTraversal t(grid, std::make_shared<const BranchMap>(grid));
  Beside beside(grid, wavy_model(grid.spec(), 8), 5);
  beside.begin(1000);
  t.walk_beside(&beside);
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
  REQUIRE(beside.answer());
  CHECK(beside.answer()->tick == 41 - 3);
  CHECK(beside.answer()->at[0] == Approx(1.4).epsilon(1e-12));  // some roundings
  CHECK(beside.answer()->row[0] == Approx(11.4).epsilon(1e-12));
}

TEST_CASE("an answer that is older than 20 ms is not used") {
  const Grid grid = line();
  CHECK(ticks_apart(grid, kEndsLate, 21) == ticks_apart(grid, kEndsLate, std::nullopt));
  Beside beside(grid, model_of_line(grid.spec(), kEndsLate), 20);
  beside.begin(1000);
  beside.start({1, 0, 0});
  for (int i = 1; i <= 20; ++i) {
    CHECK(beside.answer() == nullptr);
    beside.follow({1 + i / 100.0, 0, 0});
  }
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
  BranchTraversal t(grid, std::make_shared<const BranchMap>(grid));
  Beside beside(grid,
                std::make_unique<tiny::TestModel>(
                    grid.spec(), [](const double*, const Vec3&, const Vec3&, double*,
                                    std::string& error) { return error = "no", false; }),
                0);
  beside.begin(1000);
  t.walk_beside(&beside);
  BranchTraversal alone(grid, std::make_shared<const BranchMap>(grid));
  for (const Vec3& x : there_and_back()) {
    REQUIRE(t.step(x).usable());
    alone.step(x);
    REQUIRE(copy(t.state()) == copy(alone.state()));
  }
  CHECK(beside.kept_up() <= 2);  // at grid points, where play starts without a conversion
}

TEST_CASE("a thread follows the hand along its whole way, and nobody waits for it") {
  const Grid grid = line();
  Beside beside(grid, model_of_line(grid.spec(), kEndsLate, 100), std::nullopt);
  beside.begin(1000);
  // There and back, so that the model is on the lower branch at a place where play would start on
  // the upper one. The ring takes more places than these, and the model needs 0.1 ms for each.
  beside.start({0.25, 0, 0});
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 50; i <= 1350; ++i) beside.follow({i / 200.0, 0, 0});
  for (int i = 1350; i >= 700; --i) beside.follow({i / 200.0, 0, 0});
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  CHECK(passed.count() < 2000 * 1e-4);  // what the model needs at least
  const std::uint64_t last = beside.tick();
  // The next ticks are late enough for the model to keep up: the place stays the same.
  for (int i = 0; i < 20'000 && !(beside.answer() && beside.answer()->tick >= last); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    beside.receive();
    beside.follow({3.5, 0, 0});
  }
  REQUIRE(beside.answer());
  CHECK(beside.answer()->at == Vec3{3.5, 0, 0});
  CHECK(beside.answer()->row[0] == -100);
  CHECK(beside.kept_up() > 0);
}

/// Until the thread's answer to the last step was taken.
void wait_for_answer(BranchTraversal& t, NodeForce& force, const Beside& beside) {
  t.tell_model();
  for (int i = 0; i < 20'000; ++i) {
    REQUIRE(t.correct());
    force(t);
    if (t.last_step().snapped || (beside.answer() && beside.answer()->tick == beside.tick()))
      return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  FAIL("no answer within 20 s");
}

TEST_CASE("what the thread's model says is taken between two steps, of which the next one tells") {
  const Grid grid = line();
  const auto branches = std::make_shared<const BranchMap>(grid);
  BranchTraversal t(grid, branches);
  Beside beside(grid, model_of_line(grid.spec(), kEndsEarly), std::nullopt);
  beside.begin(1000);
  t.walk_beside(&beside);
  CHECK(t.is_corrected_between());
  CHECK_FALSE(t.correct());  // nothing has begun
  RecordFields fields;
  for (RecordIndex i = 0; i < grid.records(); ++i) fields.force.push_back({0, 0, 0});
  const auto energies = std::make_shared<NodeEnergies>(grid, fields);
  energies->add_ghosts(grid, branches->nodes);
  NodeForce force(energies, grid.box(), mean_force);
  // The model says that the branch ends at 4.3, the grid at 4.5. Nothing jumps in a step itself:
  // the one after the snap tells of it.
  int told = 0;
  bool has_snapped = false;
  for (int i = 50; i <= 870; ++i) {
    const double x = i / 200.0;
    REQUIRE(t.step({x, 0, 0}).usable());
    force(t);
    REQUIRE(t.last_step().snapped == std::exchange(has_snapped, false));
    told += t.last_step().snapped;
    REQUIRE(t.jumps() == 1 + static_cast<std::uint64_t>(told));  // the start is one
    wait_for_answer(t, force, beside);
    has_snapped = t.last_step().snapped;
    if (x < kEndsEarly - 0.01) REQUIRE(std::abs(t.state()[0] - state_at(true, x)) < 1e-12);
    if (x > kEndsEarly + 0.01) REQUIRE(t.state()[0] == state_at(false, x));
  }
  CHECK(told == 1);
}

TEST_CASE("between two answers of the thread's model, what the grid lacks stays the same") {
  const Grid grid = straight_line();
  BranchTraversal t(grid, std::make_shared<const BranchMap>(grid));
  Beside beside(grid, wavy_model(grid.spec(), 8), std::nullopt);
  beside.begin(1000);
  t.walk_beside(&beside);
  RecordFields fields;
  for (int i = 0; i < 8; ++i) fields.force.push_back({-i / 10.0, 0, 0});
  NodeForce force(std::make_shared<const NodeEnergies>(grid, fields), grid.box(), mean_force);
  const auto step = [&](double x) {
    REQUIRE(t.step({x, 0, 0}).usable());
    return force(t)[0];
  };
  // What was missing first comes within half a spacing.
  for (const double x : {2.3, 2.5, 2.7, 2.9, 2.9, 2.9}) {
    step(x);
    wait_for_answer(t, force, beside);
  }
  REQUIRE(beside.answer()->at == Vec3{2.9, 0, 0});
  // If the hand goes straight on, the answer is about where it comes to.
  for (int i = 0; i < 100; ++i) {
    const double x = 2.9 + 0.01 * std::abs(50 - i), f = step(x);
    if (i > 1 && std::abs(i - 51) > 1) {
      CHECK(std::abs(t.state()[0] - x - wave(x)) < 1e-9);  // roundings of places
      CHECK(std::abs(f + x / 10 - wave(x)) < 1e-6);        // the grid's forces are floats
    }
    wait_for_answer(t, force, beside);
  }
  for (int i = 0; i < 3; ++i) {
    step(2.9);
    wait_for_answer(t, force, beside);
  }
  for (const double x : {2.9, 2.95, 3.0, 3.05}) {  // over a point, where the corners change
    const double f = step(x);
    CHECK(std::abs(t.state()[0] - x - wave(2.9)) < 1e-12);  // some roundings
    CHECK(std::abs(f + x / 10 - wave(2.9)) < 1e-6);         // the grid's forces are floats
  }
}

TEST_CASE("with a model beside the grid no step allocates, whatever model and links say") {
  const Box box{{0, 0, 0}, 1, {8, 7, 6}};
  const Grid grid = random_grid(box, 3, 4, 3);
  BranchTraversal t(grid, std::make_shared<const BranchMap>(grid));
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

TEST_CASE("a process that fails is told of once, and one that is stuck does not hold up the end") {
  const Grid grid = line();
  const std::string first_line =
      R"(read -r line; echo '{"hapgrid": 1, "state_size": 1, "d_max": 9, "tolerance": 1e-6}')";
  const auto process = [&](const std::string& then) {
    return ProcessSource("model", {"sh", "-c", first_line + "; read -r line; " + then}, {},
                         {.timeout_seconds = 1000, .start_timeout_seconds = 1000});
  };
  std::vector<std::string> told;
  const auto tell = [&](const std::string& why) { told.push_back(why); };
  {
    Beside beside(grid, process("exit 3").create({}), 0, tell);
    beside.begin(1000);
    beside.start({0.5, 0, 0});
    beside.follow({0.6, 0, 0});
    CHECK_FALSE(beside.answer());
    CHECK(beside.kept_up() == 0);
  }
  REQUIRE(told.size() == 1);
  CHECK(told[0].find("exited with status 3; asked 3 times") != std::string::npos);
  told.clear();
  const auto begun = std::chrono::steady_clock::now();
  {
    Beside beside(grid, process("exec sleep 1000").create({}), std::nullopt, tell);
    beside.begin(1000);
    beside.start({0.5, 0, 0});
    std::this_thread::sleep_for(std::chrono::milliseconds(100));  // until the thread has asked
    beside.follow({0.6, 0, 0});
    CHECK_FALSE(beside.answer());
  }
  CHECK(std::chrono::steady_clock::now() - begun < std::chrono::seconds(60));
  CHECK(told.empty());
}
