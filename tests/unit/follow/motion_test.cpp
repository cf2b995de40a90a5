// Motions that are no small steps: jumps, places outside, what is no number; and grids that are
// none.

#include "libcore/base/error.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"
#include "tests/unit/follow/places.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

TEST_CASE("outside the box the HIP is held at its edge") {
  for (const Box& box : boxes()) {
    const Grid grid = random_grid(box, 3, 3, 11);
    std::mt19937_64 random(2);
    PaperTraversal t(grid, 1000), held(grid, 1000);
    t.start(box.position(PointIndex{0}));
    held.start(box.position(PointIndex{0}));
    for (int i = 0; i < 500; ++i) {
      Vec3 x = random_point(box, random);
      Vec3 edge = x;
      bool outside = false;
      for (int a = 0; a < 3; ++a) {
        const double low = face(box, a, 0);
        const double high = face(box, a, static_cast<int>(box.counts[a]) - 1);
        const auto kind = random() % 4;
        if (kind == 0) x[a] = random() % 2 ? std::nextafter(high, kInf) : 1e300;
        if (kind == 1) x[a] = random() % 2 ? std::nextafter(low, -kInf) : -1e300;
        outside |= kind < 2;
        edge[a] = std::clamp(x[a], low, high);
      }
      REQUIRE(t.step(x).outside == outside);
      REQUIRE_FALSE(held.step(edge).outside);
      REQUIRE(t.position() == edge);
      REQUIRE(copy(t.state()) == copy(held.state()));
      REQUIRE(t.records() == held.records());
    }
    CHECK(PaperTraversal(grid).start({1e300, -1e300, 1e300}).outside);
  }
}

TEST_CASE("a HIP that is not finite changes nothing") {
  const Box box{{0, 0, 0}, 1, {4, 4, 4}};
  const Grid grid = random_grid(box, 3, 3, 11);
  for (const double bad : {kInf, -kInf, std::nan("")})
    for (int a = 0; a < 3; ++a) {
      Vec3 x{1.5, 1.5, 1.5};
      x[a] = bad;
      PaperTraversal t(grid);
      CHECK(t.step(x).not_finite);
      CHECK(copy(t.state()) == std::vector<double>{0, 0, 0});
      CHECK(t.step({0.25, 0.5, 0.75}).usable());
      const auto before = copy(t.state());
      const StepResult r = t.step(x);
      CHECK(r.not_finite);
      CHECK_FALSE(r.usable());
      CHECK(t.position() == Vec3{0.25, 0.5, 0.75});
      CHECK(copy(t.state()) == before);
      CHECK(t.step({0.25, 0.5, 0.75}).usable());
    }
}

TEST_CASE("a jump is split into equal parts, as many as cells on its farthest axis") {
  const Box box{{0, 0, 0}, 1, {40, 9, 23}};
  const Grid grid = random_grid(box, 2, 4, 4);
  const Vec3 from{0.3, 0.6, 20.2}, to{12.7, 7.1, 20.9};
  PaperTraversal t(grid), by_hand(grid);
  t.start(from);
  by_hand.start(from);
  const StepResult r = t.step(to);
  CHECK(r.split);
  CHECK_FALSE(r.lagging);
  CHECK(switches(r) == 12);
  for (int part = 1; part <= 12; ++part)
    CHECK_FALSE(by_hand.step(part < 12 ? from + part / 12.0 * (to - from) : to).split);
  CHECK(t.records() == by_hand.records());
  CHECK(copy(t.state()) == copy(by_hand.state()));
}

TEST_CASE("the bound on sub-steps delays a jump and changes nothing else") {
  const Box box{{0, 0, 0}, 1, {40, 9, 23}};
  const Grid grid = random_grid(box, 2, 4, 4);
  const Vec3 from{0.3, 0.6, 20.2}, to{30.7, 7.1, 20.9};
  PaperTraversal bounded(grid, 8), t(grid);
  bounded.start(from);
  t.start(from);
  CHECK(switches(t.step(to)) == 30);
  for (int tick = 0; tick < 4; ++tick) {
    const StepResult r = bounded.step(to);
    CHECK(r.split);
    CHECK(r.lagging == (tick < 3));
    CHECK(switches(r) <= 8);
    // On the straight line, as far as the bound went: within the rounding of the parts.
    const double part = (bounded.position()[0] - from[0]) / (to[0] - from[0]);
    CHECK(length_of(bounded.position() - (from + part * (to - from))) < 1e-12);
  }
  CHECK(bounded.position() == to);
  CHECK(bounded.records() == t.records());
  CHECK(copy(bounded.state()) == copy(t.state()));

  // A bound of one part still gets there, one cell a tick.
  PaperTraversal slow(grid, 1);
  slow.start(from);
  int ticks = 1;
  while (slow.step(to).lagging) ++ticks;
  CHECK(ticks == 30);
}

TEST_CASE("links and points that lead nowhere are met without harm") {
  std::mt19937_64 random(8);
  int blocked = 0, went = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const Box box{{0, 0, 0}, 1, {5, 1 + static_cast<std::uint32_t>(random() % 5), 4}};
    RecordColumns columns = random_columns(box, 2, 3, random());
    for (Level& link : columns.links)
      if (random() % 16 == 0) link = static_cast<Level>(random());
    const Grid grid(spec_for(box, 2), 1, columns);
    PaperTraversal t(grid);
    StepResult r;
    bool started = false;
    for (int i = 0; i < 300; ++i) {
      const Vec3 x = random_point(box, random);
      const auto position = t.position();
      const auto before = copy(t.state());
      r = t.step(x);
      blocked += r.blocked;
      went += switches(r);
      started |= r.usable();
      if (started) require_consistent(grid, t);
      if (r.blocked && switches(r) == 0 && !r.split) {
        REQUIRE(t.position() == position);
        REQUIRE(copy(t.state()) == before);
      }
      bool is_bounded = true;  // a NaN is not
      for (const double s : t.state()) is_bounded &= std::abs(s) <= 1 + 8 * kEps;
      REQUIRE(is_bounded);
    }
  }
  CHECK(blocked > 100);
  CHECK(went > 100);

  // No point has a level.
  const Grid empty(spec_for({{0, 0, 0}, 1, {3, 3, 3}}, 2), 1, {});
  PaperTraversal t(empty);
  CHECK(t.step({1, 1, 1}).blocked);
}

TEST_CASE("a box whose points coincide in double precision is refused") {
  for (const Box& box : {Box{{1e16, 0, 0}, 0.5, {3, 3, 3}}, Box{{0, 0, 0}, 1e-310, {3, 3, 3}},
                         Box{{-1e308, 0, 0}, 1e308, {3, 1, 1}}}) {
    const Grid grid = random_grid(box, 1, 1, 1);
    CHECK_THROWS_AS(PaperTraversal(grid), Error);
  }
}

TEST_CASE("a step allocates nothing, however far the hand jumps") {
  const bool paper = GENERATE(true, false);
  const Grid grid = random_grid({{0, 0, 0}, 1, {12, 11, 10}}, 40, 4, 3);
  const auto t = by_rule(paper, grid);
  std::mt19937_64 random(3);
  std::vector<Vec3> path(20000);
  for (Vec3& x : path)
    x = {uniform(random, -2, 14), uniform(random, -2, 13), uniform(random, -2, 12)};
  path[77] = {std::nan(""), 0, 0};
  std::uint64_t usable = 0;
  const std::uint64_t before = allocations();
  t->start(path[0]);
  for (const Vec3& x : path) usable += t->step(x).usable();
  const std::uint64_t after = allocations();
  CHECK(after == before);
  CHECK(usable == path.size() - 1);
  // The counter counts.
  ::operator delete(::operator new(1));
  CHECK(allocations() > after);
}
