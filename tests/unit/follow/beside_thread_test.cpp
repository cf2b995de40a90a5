// The thread of the model beside the grid: the loop never waits for it, and a step begins with what
// it said last.

#include "libcore/follow/beside.hpp"
#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/node_force.hpp"
#include "libcore/model/process_model.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/follow/line_models.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

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

namespace {

/// Until the thread's answer to the last step is there; the next step takes it.
void wait_for_answer(Beside& beside) {
  const auto is_there = [&] {
    beside.receive();
    return beside.answer() && beside.answer()->tick == beside.tick();
  };
  for (int i = 0; i < 20'000 && !is_there(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  REQUIRE(is_there());
}

}  // namespace

TEST_CASE("a step follows what the thread's model said last, and tells of its snap") {
  const Grid grid = line();
  WalkBeside walk(grid, model_of_line(grid.spec(), kEndsEarly), std::nullopt);
  auto& [t, beside] = walk;
  // The model says that the branch ends at 4.3, the grid at 4.5.
  int told = 0;
  for (int i = 50; i <= 870; ++i) {
    const double x = i / 200.0;
    REQUIRE(t.step({x, 0, 0}).usable());
    told += t.last_step().snapped;
    REQUIRE(t.jumps() == 1 + static_cast<std::uint64_t>(told));  // the start is one
    if (x < kEndsEarly - 0.01) REQUIRE(std::abs(t.state()[0] - state_at(true, x)) < 1e-12);
    if (x > kEndsEarly + 0.01) REQUIRE(t.state()[0] == state_at(false, x));
    wait_for_answer(beside);
  }
  CHECK(told == 1);
}

TEST_CASE(
    "while the thread's model thinks, what the grid lacks stays the same for half a spacing") {
  const Grid grid = straight_line();
  const auto wavy = std::shared_ptr<Model>(wavy_model(grid.spec(), 8));
  std::atomic<bool> thinks{false};
  WalkBeside walk(
      grid,
      std::make_unique<tiny::TestModel>(
          grid.spec(),
          [&](const double* s, const Vec3& x, const Vec3& d, double* row, std::string&) {
            while (thinks) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            return wavy->convert(s, x, d, row);
          }),
      std::nullopt);
  BranchTraversal& t = walk.t;  // clang 15 takes no bindings into lambdas
  Beside& beside = walk.beside;
  RecordFields fields;
  for (int i = 0; i < 8; ++i) fields.force.push_back({-i / 10.0, 0, 0});
  NodeForce force(std::make_shared<const NodeEnergies>(node_energies(grid, fields)), grid.box(),
                  mean_force);
  const auto step = [&](double x) {
    REQUIRE(t.step({x, 0, 0}).usable());
    return force(t)[0];
  };
  // What was missing first comes within half a spacing.
  for (const double x : {2.3, 2.5, 2.7, 2.9, 2.9, 2.9}) {
    step(x);
    wait_for_answer(beside);
  }
  REQUIRE(beside.answer()->at == Vec3{2.9, 0, 0});
  // If the hand goes straight on, the answer is about where it comes to.
  for (int i = 0; i < 100; ++i) {
    const double x = 2.9 + 0.01 * std::abs(50 - i), f = step(x);
    if (i > 1 && std::abs(i - 51) > 1) {
      CHECK(std::abs(t.state()[0] - x - wave(x)) < 1e-9);  // roundings of places
      CHECK(std::abs(f + x / 10 - wave(x)) < 1e-6);        // the grid's forces are floats
    }
    wait_for_answer(beside);
  }
  for (int i = 0; i < 20; ++i) {  // until no other answer is kept
    step(2.9);
    wait_for_answer(beside);
  }
  thinks = true;
  // Over a point, where the corners change, and up to half a spacing from the last answer.
  for (const double x : {2.9, 2.95, 3.0, 3.05, 3.39}) {
    const double f = step(x);
    CHECK(std::abs(t.state()[0] - x - wave(2.9)) < 1e-12);  // some roundings
    CHECK(std::abs(f + x / 10 - wave(2.9)) < 1e-6);         // the grid's forces are floats
  }
  // Farther on it fades within half a spacing: the grid alone decides.
  for (const double x : {3.41, 3.7, 3.95}) step(x);
  CHECK(t.state()[0] == Approx(3.95).epsilon(1e-12));
  CHECK(std::abs(step(3.95) + 0.395) < 1e-6);
  thinks = false;
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
    Beside beside(grid, process("exit 3").create({}), 1, tell);
    beside.begin(1000);
    beside.start({0.5, 0, 0});
    beside.follow({0.6, 0, 0});
    beside.receive();
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
