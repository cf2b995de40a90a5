// The hand goes on to the next level at its place: against states that are known.

#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/paper_traversal.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"
#include "tests/unit/follow/line_models.hpp"
#include "tests/unit/follow/places.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

/// Each point has as many levels as `levels`, and the state of level l at x is 100 l + x + 2 y.
Grid sheets(const Box& box, Level levels) {
  const Neighbourhood around(box);
  RecordColumns columns;
  for (PointIndex p = 0; p < box.points(); ++p)
    for (Level level = 0; level < levels; ++level) {
      const Vec3 x = box.position(p);
      add_record(columns, around, p, level, std::array{100.0 * level + x[0] + 2 * x[1]},
                 [&](PointIndex) { return level; });
    }
  return Grid(spec_for(box, 1), 1, columns);
}

}  // namespace

TEST_CASE("each press goes on to the next level, round and round") {
  const bool paper = GENERATE(true, false);
  const Grid grid = sheets({{0, 0, 0}, 1, {5, 4, 1}}, 3);
  const auto t = by_rule(paper, grid);
  const auto state = [](int level, const Vec3& x) { return 100 * level + x[0] + 2 * x[1]; };
  Vec3 x{0.25, 0.75, 0};
  t->start(x);
  std::uint64_t jumps = t->jumps();
  int level = 0;
  for (int i = 0; i < 40; ++i) {
    // Within a cell and over faces and edges.
    x = {0.25 + 0.09 * i, 0.75 + 0.05 * i, 0};
    const bool next = i % 3 == 1;
    const std::uint64_t before = allocations();
    const StepResult step = t->step(x, next);
    CHECK(allocations() == before);
    if (next) level = (level + 1) % 3;
    jumps += next;
    REQUIRE(step.usable());
    CHECK(step.snapped == next);
    CHECK(step.level_changed == next);
    CHECK(step.chosen == (next ? level : kNoLevel));
    CHECK(t->jumps() == jumps);
    // The sum of four products of numbers below 210: some roundings of each.
    CHECK(std::abs(t->state()[0] - state(level, x)) < 1e-12);
    for (const Level at : t->levels()) CHECK(at == level);
  }
  // A start takes the level that it is told, where there is one.
  CHECK(t->start(x, 2).usable());
  CHECK(std::abs(t->state()[0] - state(2, x)) < 1e-12);
  CHECK(t->start(x, 3).blocked);
}

TEST_CASE("where there is one level nothing happens") {
  const bool paper = GENERATE(true, false);
  const Grid grid = sheets({{0, 0, 0}, 1, {5, 4, 3}}, 1);
  const auto t = by_rule(paper, grid), other = by_rule(paper, grid);
  for (int i = 0; i < 30; ++i) {
    const Vec3 x{0.1 + 0.12 * i, 0.3 + 0.08 * i, 0.05 * i};
    const StepResult step = t->step(x, true);
    other->step(x);
    CHECK_FALSE(step.snapped);
    CHECK(step.chosen == kNoLevel);
    CHECK(copy(t->row()) == copy(other->row()));
  }
}

TEST_CASE("only a branch that reaches the place can be chosen") {
  // Level 0 is 10 + x up to 4.5, level 1 is -100.
  const Grid grid = line();
  BranchTraversal t(grid, std::make_shared<const BranchNodes>(grid));
  const double ends = 4.5;
  t.start({4.1, 0, 0});
  CHECK(t.state()[0] == Approx(14.1));
  CHECK(t.step({4.2, 0, 0}, true).chosen == 1);
  CHECK(t.state()[0] == Approx(-100));
  CHECK(t.step({ends - 0.01, 0, 0}, true).chosen == 0);
  CHECK(t.state()[0] == Approx(10 + ends - 0.01));
  CHECK(t.step({ends + 0.01, 0, 0}).snapped);
  CHECK(t.step({ends + 0.02, 0, 0}, true).chosen ==
        kNoLevel);  // nearest to 4, whose level 0 has ended
  CHECK(t.state()[0] == Approx(-100));
  CHECK(t.step({4.9, 0, 0}, true).chosen == kNoLevel);  // nearest to 5, which has one level
  CHECK(t.state()[0] == Approx(-100));
}
