// Which levels a traversal follows, against the paper's text.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "libcore/haptic/playable.hpp"
#include "tests/unit/haptic/literal.hpp"
#include "tests/unit/haptic/places.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

TEST_CASE("levels along random walks are those of the paper's text") {
  std::uint64_t seed = 0;
  for (const Box& box : boxes()) {
    const Grid grid = random_grid(box, 1, 4, ++seed);
    std::mt19937_64 random(seed);
    PaperTraversal t(grid);
    Literal literal(grid);

    // Design 7.3: the corner nearest to the HIP at level 0.
    const Vec3 first = random_point(box, random);
    REQUIRE(t.start(first).usable());
    Literal::Point nearest{};
    for (int a = 0; a < 3; ++a) {
      double best = kInf;
      for (int c = 0; c < static_cast<int>(box.counts[a]); ++c)
        if (std::abs(first[a] - face(box, a, c)) < best) {
          best = std::abs(first[a] - face(box, a, c));
          nearest[a] = c;
        }
    }
    literal.start(cell_of(t), nearest);
    REQUIRE(t.levels() == literal.levels());

    int seen = 0;
    for (int i = 0; i < 20000; ++i) {
      Cell near = literal.cell();
      for (int a = 0; a < 3; ++a)
        near[a] = std::clamp(near[a] + static_cast<int>(random() % 3) - 1, 0,
                             std::max(static_cast<int>(box.counts[a]) - 2, 0));
      const Vec3 x = random_point_in(box, near, random);
      const Cell next = cell_from(box, literal.cell(), x);
      const bool moved = next != literal.cell();
      if (moved) literal.move_to(next);
      const StepResult r = t.step(x);
      REQUIRE(switches(r) == moved);
      REQUIRE(r.level_changed == (moved && literal.changed()));
      REQUIRE(cell_of(t) == next);
      REQUIRE(t.levels() == literal.levels());
      require_consistent(grid, t);
      seen += moved;
    }
    if (box.points() > 8) CHECK(seen > 1000);
  }
}

TEST_CASE("the way there and the way back differ where the grid says so") {
  // Along x, as in Fig. 2: 0 outside, +1 pushed from the left (level 1), -1 from the right (level
  // 0), torn off at the ends.
  const Box box{{0, 0, 0}, 1, {6, 1, 1}};
  const int right = Direction::of(1, 0, 0).q(), left = Direction::of(-1, 0, 0).q();
  RecordColumns columns;
  const auto add = [&](PointIndex p, Level level, double state, Level to_left, Level to_right) {
    columns.point.push_back(p);
    columns.level.push_back(level);
    columns.generation.push_back(0);
    columns.rows.push_back(state);
    columns.links.resize(columns.links.size() + kDirections, kLeavesBox);
    Level* const links = &columns.links[columns.links.size() - kDirections];
    if (p > 0) links[left] = to_left;
    if (p < 5) links[right] = to_right;
  };
  add(0, 0, 0, 0, 0);
  add(1, 0, 0, 0, 1);
  add(2, 0, -1, 0, 0);
  add(2, 1, +1, 0, 1);
  add(3, 0, -1, 0, 0);
  add(3, 1, +1, 1, 0);
  add(4, 0, 0, 0, 0);
  add(5, 0, 0, 0, 0);
  const Grid grid(spec_for(box, 1), 1, columns);
  require_playable(grid, "grid");

  PaperTraversal t(grid);
  const auto at = [&](double x) {
    t.step({x, 0, 0});
    return t.state()[0];
  };
  CHECK(at(0.5) == 0);
  CHECK(at(1.5) == 0.5);
  CHECK(at(2.5) == 1);
  CHECK(at(2.0) == 1);  // back and forth on the branch
  CHECK(at(2.75) == 1);
  CHECK(at(3.5) == 0.5);
  CHECK(t.step({4.5, 0, 0}).level_changed == false);
  CHECK(t.state()[0] == 0);
  CHECK(at(3.5) == -0.5);
  CHECK(at(2.5) == -1);
  CHECK(at(1.25) == -0.25);
  CHECK(at(0.5) == 0);
  CHECK(t.step({1.5, 0, 0}).level_changed);
  CHECK(at(2.5) == 1);

  // One long jump does what the way does.
  PaperTraversal jump(grid);
  jump.step({0.5, 0, 0});
  CHECK(jump.step({2.5, 0, 0}).split);
  CHECK(jump.state()[0] == 1);
}

TEST_CASE("a HIP at rest on a face does not flap") {
  const Box box{{-0.975, -0.475, -0.475}, 0.05, {9, 7, 8}};
  const Grid grid = random_grid(box, 1, 2, 1);
  for (const double side : {-kInf, kInf}) {
    const double on = face(box, 0, 3);
    Vec3 x{on, -0.46, -0.46};
    PaperTraversal t(grid);
    t.start({on + (side > 0 ? 0.01 : -0.01), x[1], x[2]});
    for (int i = 0; i < 10; ++i) {
      x[0] = i % 2 ? on : std::nextafter(on, side);
      CHECK(switches(t.step(x)) == 0);
    }
  }
}
