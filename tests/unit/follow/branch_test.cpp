// The rule that stays on a branch: where it must agree with the paper's, where it must snap, and
// that the state jumps nowhere else.

#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/paper_traversal.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/check/tiny_grid.hpp"
#include "tests/unit/follow/line_models.hpp"
#include "tests/unit/follow/places.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

/// Two branches of a unit grid. The one is where normal·x < reach, with the state slope·x, and
/// snaps at the plane to the other, which is everywhere, with the state -100.
struct Half {
  Vec3 normal, slope;
  double reach;

  bool has_upper(const Vec3& x) const { return dot(normal, x) < reach; }

  Grid grid(const Box& box) const {
    const Neighbourhood around(box);
    RecordColumns columns;
    for (PointIndex p = 0; p < box.points(); ++p)
      for (int level = has_upper(box.position(p)) ? 0 : 1; level < 2; ++level) {
        const Vec3 x = box.position(p);
        add_record(columns, around, p, static_cast<Level>(has_upper(x) ? level : 0),
                   std::array{level == 0 ? dot(slope, x) : -100.0},
                   [&](PointIndex to) { return has_upper(box.position(to)) && level == 1; });
      }
    return Grid(spec_for(box, 1), 1, columns);
  }
};

}  // namespace

TEST_CASE("on a grid of one branch both rules give the same bits") {
  for (const Box& box : boxes()) {
    const Grid grid = random_grid(box, 3, 1, 5);
    const auto map = std::make_shared<const BranchNodes>(grid);
    CHECK(map->ghosts() == 0);
    PaperTraversal paper(grid);
    BranchTraversal branch(grid, map);
    std::mt19937_64 random(5);
    for (int i = 0; i < 3000; ++i) {
      const Vec3 x = random_point(box, random);
      REQUIRE(paper.step(x).usable());
      const StepResult r = branch.step(x);
      REQUIRE(r.usable());
      REQUIRE_FALSE(r.snapped);
      REQUIRE(copy(branch.row()) == copy(paper.row()));
      REQUIRE(branch.records() == paper.records());
    }
  }
}

TEST_CASE("along a line the state snaps in the middle of a link, and comes back elsewhere") {
  // 0 1 2 3 4 on the upper branch, which ends behind 4; the lower one, -100, from 3 on, ends before
  // 3 on the way back.
  const Grid grid(spec_for(line_box(), 1), 1, line_columns());
  const auto map = std::make_shared<const BranchNodes>(grid);
  REQUIRE(map->ghosts() == 2);
  BranchTraversal t(grid, map);
  const double ends = 4.5, comes_back = 2.5;
  int snaps = 0;
  const auto go = [&](double from, double to, auto&& expected) {
    for (int i = 0; i <= 1000; ++i) {
      const double x = from + (to - from) * i / 1000;
      snaps += t.step({x, 0, 0}).snapped;
      // States are linear on a branch, so that even the ghosts are exact: some roundings of 100.
      CHECK(std::abs(t.state()[0] - expected(x)) < 1e-12);
    }
  };
  go(0.25, 6.75, [&](double x) { return x <= ends ? 10 + x : -100; });
  go(6.75, 0.25, [&](double x) { return x >= comes_back ? -100 : 10 + x; });
  CHECK(snaps == 2);
  // Turning back before the end costs nothing.
  go(0.25, ends - 0.01, [](double x) { return 10 + x; });
  go(ends - 0.01, 0.25, [](double x) { return 10 + x; });
  CHECK(snaps == 2);
}

TEST_CASE("at a plane the state snaps near the plane") {
  // Two spacings from the sides of the box, where a branch cannot be extrapolated.
  const Box box{{0, 0, 0}, 1, {9, 9, 9}};
  for (const Vec3& normal : {Vec3{1, 0, 0}, Vec3{0.6, 0.8, 0}, Vec3{0.48, 0.6, 0.64}}) {
    const Half half{normal, {0.3, -0.2, 0.1}, dot(normal, {4.2, 4.2, 4.2})};
    const Grid grid = half.grid(box);
    const auto map = std::make_shared<const BranchNodes>(grid);
    BranchTraversal t(grid, map);
    std::mt19937_64 random(7);
    int paths = 0;
    while (paths < 100) {
      const auto any = [&] {
        return Vec3{uniform(random, 2, 6), uniform(random, 2, 6), uniform(random, 2, 6)};
      };
      const Vec3 from = any(), to = any();
      // So far on the upper side that the nearest corner is there too.
      if (dot(normal, from) > half.reach - 1 || dot(normal, to) < half.reach + 1) continue;
      ++paths;
      t.start(from);
      double snapped_at = -1;
      for (int i = 1; i <= 1000 && snapped_at < 0; ++i) {
        const Vec3 x = from + i / 1000.0 * (to - from);
        if (t.step(x).snapped) snapped_at = dot(normal, x);
        // On the branch up to the end, and off it behind: the slope is exact in ghosts, too.
        CHECK(std::abs(t.state()[0] - (snapped_at < 0 ? dot(half.slope, x) : -100)) < 1e-12);
      }
      // Corners of a cell are at most 1.72 spacings apart along the normal, and half of the weight
      // is on either side of the plane; a tick is 0.01 at most.
      CHECK(std::abs(snapped_at - half.reach) < 1.72 / 2 + 0.01);
    }
  }
}

TEST_CASE("whatever the links are, the state jumps only where it snaps") {
  constexpr int kSteps = 20000;
  std::uint64_t seed = 0, snaps = 0;
  for (const Box& box : boxes()) {
    if (box.origin[0] == 1e9) continue;  // there a step is not small against the rounding
    for (unsigned levels = 2; levels <= 4; ++levels) {
      const Grid grid = random_grid(box, 2, levels, ++seed);
      const auto map = std::make_shared<const BranchNodes>(grid);
      BranchTraversal t(grid, map);
      std::mt19937_64 random(seed);
      Vec3 x = random_point(box, random);
      REQUIRE(t.start(x).usable());
      std::vector<double> before(t.row().size());
      for (int leg = 0; leg < 3; ++leg) {
        x = t.position();  // a leg can end outside the box
        const Vec3 beyond = x + 3 * (random_point_in(box, cell_of(t), random) - x);
        double largest_step = 0;
        bool is_usable = true;
        for (int i = 0; i < kSteps; ++i) {
          const Vec3 next = x + 1.0 / (kSteps - i) * (beyond - x);
          std::copy(t.row().begin(), t.row().end(), before.begin());
          const auto r = t.step(next);
          is_usable &= r.usable();
          x = next;
          snaps += r.snapped;
          if (r.snapped) continue;
          // States are in [-1, 1] and ghosts in [-7, 7], and a step is at most 1.5e-4 spacings an
          // axis: so the blend moves by 3 x 14 x 1.5e-4 at most. An offset of 70, from five changes
          // of all corners within half a spacing, fades by 70 x 2 x sqrt(3) x 1.5e-4.
          for (std::size_t c = 0; c < before.size(); ++c)
            largest_step = std::max(largest_step, std::abs(t.row()[c] - before[c]));
        }
        REQUIRE(is_usable);
        REQUIRE(largest_step < 0.0063 + 0.0364);
      }
    }
  }
  CHECK(snaps > 100);
}

TEST_CASE("where the hand rests, the state does not go on snapping") {
  std::uint64_t seed = 100, places = 0, endless = 0;
  for (const Box& box : boxes())
    for (unsigned levels = 2; levels <= 4; ++levels) {
      const Grid grid = random_grid(box, 2, levels, ++seed);
      BranchTraversal t(grid, std::make_shared<const BranchNodes>(grid));
      std::mt19937_64 random(seed);
      for (int i = 0; i < 2000; ++i) {
        const Vec3 x = random_point(box, random);
        REQUIRE(t.step(x).usable());
        int snaps = 0;
        while (snaps < 10 && t.step(x).snapped) ++snaps;
        ++places;
        endless += snaps == 10;
      }
    }
  // Random links can lead in a circle, which they do at 91 of 42,000 places. If anchors were taken
  // whose branch has ended, it would be 691.
  CHECK(endless * 200 < places);
}
