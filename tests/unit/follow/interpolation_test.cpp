// The state of a traversal: interpolation and its continuity.

#include "tests/unit/catch.hpp"
#include "tests/unit/follow/places.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

TEST_CASE("a grid point gives its stored state to the last bit") {
  for (const Box& box : boxes()) {
    const Grid grid = random_grid(box, 5, 3, 7);
    PaperTraversal t(grid);
    for (int pass = 0; pass < 2; ++pass)  // afresh, and followed along all points
      for (PointIndex p = 0; p < box.points(); ++p) {
        const Vec3 x = box.position(p);
        const StepResult r = pass == 0 ? t.start(x) : t.step(x);
        REQUIRE(r.usable());
        REQUIRE_FALSE(r.outside);
        bool found = false;
        for (int corner = 0; corner < 8; ++corner)
          if (grid.point(t.records()[corner]) == p) {
            found = true;
            REQUIRE(copy(t.state()) == copy(grid.state(t.records()[corner])));
          }
        REQUIRE(found);
      }
  }
}

TEST_CASE("inside a cell the state is the trilinear interpolation") {
  const Box box{{-0.975, -0.475, -0.475}, 0.05, {9, 7, 8}};
  const Grid grid = random_grid(box, 4, 2, 3);
  PaperTraversal t(grid);
  std::mt19937_64 random(5);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = random_point(box, random);
    t.step(x);
    std::vector<long double> expected(4, 0);
    for (int corner = 0; corner < 8; ++corner) {
      long double w = 1;
      for (int a = 0; a < 3; ++a) {
        const int c = static_cast<int>(t.cell()[a]);
        const long double low = face(box, a, c), high = face(box, a, c + 1);
        const long double xbar = (x[a] - low) / (high - low);
        w *= corner >> a & 1 ? xbar : 1 - xbar;
      }
      for (int i2 = 0; i2 < 4; ++i2) expected[i2] += w * grid.state(t.records()[corner])[i2];
    }
    // States are below 1 in magnitude. xbar is wrong by 3 eps/2 of itself (1/width, its rounding
    // up, the product; x - low is within eps/2 of |x| <= 1, that is 10 eps of the width 0.05), in
    // each of three axes, where it moves the result by at most 2; the sum adds some 5 eps.
    for (int i2 = 0; i2 < 4; ++i2)
      REQUIRE(std::abs(static_cast<double>(t.state()[i2] - expected[i2])) <= 80 * kEps);
  }
}

TEST_CASE("the state is continuous across every face, edge and vertex") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Box box{{-0.975, 0.1, 1e3}, 0.05, {3, 3, 3}};
    const Grid grid = random_grid(box, 9, 3, seed);
    std::mt19937_64 random(seed);
    for (int q = 0; q < kDirections; ++q)
      for (int repeat = 0; repeat < 20; ++repeat) {
        const auto move = Direction(q).step();
        Vec3 inside, common, beyond;
        for (int a = 0; a < 3; ++a) {
          const int from = move[a] < 0 ? 1 : 0;
          const double low = face(box, a, from), high = face(box, a, from + 1);
          inside[a] = uniform(random, low, high);
          common[a] = move[a] == 0 ? uniform(random, low, high) : move[a] > 0 ? high : low;
          beyond[a] = move[a] == 0 ? common[a] : std::nextafter(common[a], move[a] * kInf);
        }
        PaperTraversal t(grid);
        t.start(inside);
        REQUIRE(switches(t.step(common)) == 0);
        const auto before = copy(t.state());
        const auto records = t.records();
        const Cell cell = cell_of(t);

        const StepResult r = t.step(beyond);
        const int axes = std::abs(move[0]) + std::abs(move[1]) + std::abs(move[2]);
        CHECK(r.face_switches == (axes == 1));
        CHECK(r.edge_switches == (axes == 2));
        CHECK(r.vertex_switches == (axes == 3));
        for (int a = 0; a < 3; ++a) REQUIRE(cell_of(t)[a] == cell[a] + move[a]);

        // Levels are kept in the common vertices.
        int shared = 0;
        for (const RecordIndex old : records)
          for (const RecordIndex now : t.records())
            if (grid.point(old) == grid.point(now)) {
              ++shared;
              REQUIRE(old == now);
            }
        CHECK(shared == (axes == 1 ? 4 : axes == 2 ? 2 : 1));

        // From the other side: the bound is 0, see the head of traversal.hpp.
        REQUIRE(switches(t.step(common)) == 0);
        REQUIRE(copy(t.state()) == before);
      }
  }
}
