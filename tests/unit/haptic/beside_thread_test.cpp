// The thread of the model beside the grid: the loop never waits for it, and takes what it says
// between two steps.
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "libcore/haptic/branch_traversal.hpp"
#include "libcore/haptic/node_force.hpp"
#include "libcore/model/process_model.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/haptic/line_models.hpp"

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

}  // namespace

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
