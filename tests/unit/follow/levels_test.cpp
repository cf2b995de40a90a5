// Which levels a traversal follows, against the paper's text.

#include "tests/unit/catch.hpp"
#include "tests/unit/follow/literal.hpp"
#include "tests/unit/follow/places.hpp"

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
    for (int i = 0; i < 2000; ++i) {
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
    if (box.points() > 8) CHECK(seen > 400);
  }
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
