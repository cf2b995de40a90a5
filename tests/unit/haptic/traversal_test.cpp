#include "libcore/haptic/traversal.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "libcore/base/error.hpp"
#include "tests/unit/haptic/count_allocations.hpp"
#include "tests/unit/haptic/random_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kEps = std::numeric_limits<double>::epsilon();

using Cell = std::array<int, 3>;

double face(const Box& box, int axis, int c) {
  GridCoordinates at{0, 0, 0};
  at[axis] = static_cast<std::uint32_t>(c);
  return box.position(at)[axis];
}

/// Boxes whose coordinates round in different ways, some flat along an axis.
std::vector<Box> boxes() {
  return {{{-0.975, -0.475, -0.475}, 0.05, {9, 7, 8}},
          {{1e9, -1e9, 0}, 1e-6, {8, 9, 7}},  // a cell is some 8 roundings wide
          // The double above the coordinate 26 along x divides to less than 26.
          {{-0.0095385487122899223, 0, 0}, 0.0050991373961599166, {30, 4, 3}},
          {{0.1, 0.2, 0.3}, 1.0 / 3, {7, 1, 6}},
          {{0, 0, 0}, 1e-150, {1, 8, 1}},
          {{-3, 5, 7}, 2, {2, 2, 2}},
          {{1, 2, 3}, 0.7, {1, 1, 1}}};
}

/// A point of the box; every other coordinate is on a face or a rounding beside one.
Vec3 random_point(const Box& box, std::mt19937_64& random) {
  Vec3 x;
  for (int a = 0; a < 3; ++a) {
    const double low = face(box, a, 0);
    const double high = face(box, a, static_cast<int>(box.counts[a]) - 1);
    const double on = face(box, a, static_cast<int>(random() % box.counts[a]));
    const auto kind = random() % 6;
    x[a] = kind == 0   ? on
           : kind == 1 ? std::nextafter(on, kInf)
           : kind == 2 ? std::nextafter(on, -kInf)
                       : uniform(random, low, high);
    x[a] = std::clamp(x[a], low, high);
  }
  return x;
}

/// A point of a closed cell, often on its boundary.
Vec3 random_point_in(const Box& box, const Cell& cell, std::mt19937_64& random) {
  Vec3 x;
  for (int a = 0; a < 3; ++a) {
    const double low = face(box, a, cell[a]);
    const double high = box.counts[a] > 1 ? face(box, a, cell[a] + 1) : low;
    const auto kind = random() % 6;
    x[a] = kind == 0 ? low : kind == 1 ? high : std::min(uniform(random, low, high), high);
  }
  return x;
}

std::vector<double> copy(std::span<const double> s) { return {s.begin(), s.end()}; }

/// Sect. 2.4 as its text reads, with maps from grid points and no tables: the oracle.
class Literal {
 public:
  using Point = std::array<int, 3>;

  explicit Literal(const Grid& grid) : grid_(grid) {}

  /// The vertices of a cell; along an axis with one point both ends are the same.
  std::vector<Point> vertices(const Cell& cell) const {
    std::vector<Point> all;
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
          Point p = cell;
          const Point corner{i, j, k};
          for (int a = 0; a < 3; ++a)
            if (grid_.box().counts[a] > 1) p[a] += corner[a];
          all.push_back(p);
        }
    return all;
  }

  void start(const Cell& cell, const Point& nearest) {
    cell_ = cell;
    levels_.clear();
    levels_[nearest] = 0;
    for (const Point& v : vertices(cell)) convert(levels_, nearest, 0, v, levels_);
  }

  void move_to(const Cell& cell) {
    changed_ = false;
    std::map<Point, int> common;
    for (const Point& v : vertices(cell))
      if (levels_.count(v)) common[v] = levels_.at(v);
    std::map<Point, int> next = common;
    // "Preserve levels in all common vertices"; each other vertex v is reached from the common
    // vertex y with v - y perpendicular to what the cells share.
    for (const Point& v : vertices(cell))
      for (const auto& [y, level] : common) {
        bool perpendicular = true;
        for (int a = 0; a < 3; ++a)
          if (cell[a] == cell_[a]) perpendicular &= v[a] == y[a];
        if (perpendicular) convert(common, y, level, v, next);
      }
    levels_ = next;
    cell_ = cell;
  }

  /// Whether a conversion of the last move_to() led to another level number than it came from.
  bool changed() const { return changed_; }

  std::array<Level, 8> levels() const {
    std::array<Level, 8> result{};
    const auto v = vertices(cell_);
    for (int corner = 0; corner < 8; ++corner)
      result[corner] = static_cast<Level>(levels_.at(v[corner]));
    return result;
  }

  const Cell& cell() const { return cell_; }

 private:
  PointIndex index(const Point& p) const {
    return grid_.box().index({static_cast<std::uint32_t>(p[0]), static_cast<std::uint32_t>(p[1]),
                              static_cast<std::uint32_t>(p[2])});
  }

  void convert(const std::map<Point, int>& known, const Point& y, int level, const Point& v,
               std::map<Point, int>& to) {
    if (known.count(v)) return;
    const RecordIndex record = grid_.first(index(y)) + static_cast<RecordIndex>(level);
    const int q = Direction::of(v[0] - y[0], v[1] - y[1], v[2] - y[2]).q();
    to[v] = grid_.links(record)[q];
    changed_ |= to[v] != level;
  }

  const Grid& grid_;
  Cell cell_{};
  bool changed_ = false;
  std::map<Point, int> levels_;
};

Cell cell_of(const Traversal& t) {
  return {static_cast<int>(t.cell()[0]), static_cast<int>(t.cell()[1]),
          static_cast<int>(t.cell()[2])};
}

int switches(const StepResult& r) { return r.face_switches + r.edge_switches + r.vertex_switches; }

/// The cell that x belongs to when the HIP comes from `from`, by trying all of them: of the closed
/// cells that hold x the nearest.
Cell cell_from(const Box& box, const Cell& from, const Vec3& x) {
  Cell cell = from;
  for (int a = 0; a < 3; ++a) {
    int best = -1;
    for (int c = 0; c == 0 || c + 1 < static_cast<int>(box.counts[a]); ++c) {
      const double high = box.counts[a] > 1 ? face(box, a, c + 1) : face(box, a, c);
      if (x[a] < face(box, a, c) || x[a] > high) continue;
      if (best < 0 || std::abs(c - from[a]) < std::abs(best - from[a])) best = c;
    }
    REQUIRE(best >= 0);
    cell[a] = best;
  }
  return cell;
}

/// Records, levels and cell of a traversal belong together, whatever happened to it.
void require_consistent(const Grid& grid, const Traversal& t) {
  const Box& box = grid.box();
  for (int corner = 0; corner < 8; ++corner) {
    GridCoordinates c = t.cell();
    for (int a = 0; a < 3; ++a) c[a] += box.counts[a] > 1 ? corner >> a & 1 : 0;
    for (int a = 0; a < 3; ++a) REQUIRE(c[a] < box.counts[a]);
    const PointIndex p = box.index(c);
    REQUIRE(t.levels()[corner] < grid.levels(p));
    REQUIRE(t.records()[corner] == grid.first(p) + t.levels()[corner]);
  }
  for (int a = 0; a < 3; ++a) {
    const int c = static_cast<int>(t.cell()[a]);
    REQUIRE(t.position()[a] >= face(box, a, c));
    REQUIRE(t.position()[a] <= face(box, a, box.counts[a] > 1 ? c + 1 : c));
  }
}

}  // namespace

TEST_CASE("corner weights sum to 1 and are exact in the corners") {
  std::mt19937_64 random(1);
  for (int i = 0; i < 10000; ++i) {
    const Vec3 x{uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1)};
    long double sum = 0;
    for (const double w : corner_weights(x)) {
      REQUIRE(w >= 0);
      sum += w;
    }
    // 1 - x is wrong by eps/4 at most, three times; the two products by eps/2 each: below 2 eps.
    REQUIRE(std::abs(static_cast<double>(sum - 1)) <= 2 * kEps);
  }
  for (int corner = 0; corner < 8; ++corner) {
    const auto w =
        corner_weights({double(corner & 1), double(corner >> 1 & 1), double(corner >> 2)});
    for (int other = 0; other < 8; ++other) CHECK(w[other] == (other == corner ? 1 : 0));
  }
}

TEST_CASE("a grid point gives its stored state to the last bit") {
  for (const Box& box : boxes()) {
    const Grid grid = random_grid(box, 5, 3, 7);
    Traversal t(grid);
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
  Traversal t(grid);
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
        Traversal t(grid);
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

TEST_CASE("levels along random walks are those of the paper's text") {
  std::uint64_t seed = 0;
  for (const Box& box : boxes()) {
    const Grid grid = random_grid(box, 1, 4, ++seed);
    std::mt19937_64 random(seed);
    Traversal t(grid);
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
  const Grid grid(spec_for(box, 1), 1, std::move(columns));
  require_playable(grid, "grid");

  Traversal t(grid);
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
  Traversal jump(grid);
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
    Traversal t(grid);
    t.start({on + (side > 0 ? 0.01 : -0.01), x[1], x[2]});
    for (int i = 0; i < 10; ++i) {
      x[0] = i % 2 ? on : std::nextafter(on, side);
      CHECK(switches(t.step(x)) == 0);
    }
  }
}

TEST_CASE("outside the box the HIP is held at its edge") {
  for (const Box& box : boxes()) {
    const Grid grid = random_grid(box, 3, 3, 11);
    std::mt19937_64 random(2);
    Traversal t(grid, 1000), held(grid, 1000);
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
    CHECK(Traversal(grid).start({1e300, -1e300, 1e300}).outside);
  }
}

TEST_CASE("a HIP that is not finite changes nothing") {
  const Box box{{0, 0, 0}, 1, {4, 4, 4}};
  const Grid grid = random_grid(box, 3, 3, 11);
  for (const double bad : {kInf, -kInf, std::nan("")})
    for (int a = 0; a < 3; ++a) {
      Vec3 x{1.5, 1.5, 1.5};
      x[a] = bad;
      Traversal t(grid);
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
  const Box box{{0, 0, 0}, 1, {40, 40, 40}};
  const Grid grid = random_grid(box, 2, 4, 4);
  const Vec3 from{0.3, 0.6, 20.2}, to{12.7, 7.1, 20.9};
  Traversal t(grid), by_hand(grid);
  t.start(from);
  by_hand.start(from);
  const StepResult r = t.step(to);
  CHECK(r.split);
  CHECK_FALSE(r.lagging);
  CHECK(switches(r) == 12);
  for (int part = 1; part <= 12; ++part) {
    Vec3 x = to;
    for (int a = 0; a < 3 && part < 12; ++a) x[a] = from[a] + (to[a] - from[a]) * part / 12;
    CHECK_FALSE(by_hand.step(x).split);
  }
  CHECK(t.records() == by_hand.records());
  CHECK(copy(t.state()) == copy(by_hand.state()));
}

TEST_CASE("the bound on sub-steps delays a jump and changes nothing else") {
  const Box box{{0, 0, 0}, 1, {40, 40, 40}};
  const Grid grid = random_grid(box, 2, 4, 4);
  const Vec3 from{0.3, 0.6, 20.2}, to{30.7, 7.1, 20.9};
  Traversal bounded(grid, 8), t(grid);
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
    for (int a = 0; a < 3; ++a)
      CHECK(std::abs(bounded.position()[a] - (from[a] + part * (to[a] - from[a]))) < 1e-12);
  }
  CHECK(bounded.position() == to);
  CHECK(bounded.records() == t.records());
  CHECK(copy(bounded.state()) == copy(t.state()));

  // A bound of one part still gets there, one cell a tick.
  Traversal slow(grid, 1);
  slow.start(from);
  int ticks = 1;
  while (slow.step(to).lagging) ++ticks;
  CHECK(ticks == 30);
}

TEST_CASE("random jumps end where they should") {
  for (const Box& box : boxes()) {
    const Grid grid = random_grid(box, 3, 4, 9);
    std::mt19937_64 random(3);
    Traversal t(grid);
    t.start(random_point(box, random));
    for (int i = 0; i < 5000; ++i) {
      const Vec3 x = random_point(box, random);
      const Cell from = cell_of(t);
      const Cell to = cell_from(box, from, x);
      const StepResult r = t.step(x);
      REQUIRE(r.usable());
      REQUIRE_FALSE(r.lagging);
      REQUIRE(t.position() == x);
      REQUIRE(cell_of(t) == to);
      int distance = 0;
      for (int a = 0; a < 3; ++a) distance = std::max(distance, std::abs(to[a] - from[a]));
      REQUIRE(r.split == (distance > 1));
      REQUIRE(switches(r) >= distance);
      require_consistent(grid, t);
    }
  }
}

TEST_CASE("links and points that lead nowhere are met without harm") {
  std::mt19937_64 random(8);
  int blocked = 0, went = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Box box{{0, 0, 0}, 1, {5, 1 + static_cast<std::uint32_t>(random() % 5), 4}};
    RecordColumns columns = random_columns(box, 2, 3, random());
    for (Level& link : columns.links)
      if (random() % 16 == 0) link = static_cast<Level>(random());
    const Grid grid(spec_for(box, 2), 1, std::move(columns));
    Traversal t(grid);
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
      for (const double s : t.state()) REQUIRE(std::abs(s) <= 1 + 8 * kEps);
    }
  }
  CHECK(blocked > 100);
  CHECK(went > 100);

  // No point has a level.
  const Grid empty(spec_for({{0, 0, 0}, 1, {3, 3, 3}}, 2), 1, {});
  Traversal t(empty);
  CHECK(t.step({1, 1, 1}).blocked);
}

TEST_CASE("only a complete grid is playable") {
  const Box box{{0, 0, 0}, 1, {3, 3, 3}};
  const RecordColumns good = random_columns(box, 2, 2, 5);
  const auto refusal = [&](RecordColumns columns, std::uint32_t generation = 1) {
    try {
      require_playable(Grid(spec_for(box, 2), generation, std::move(columns)), "x.grid");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(refusal(good) == "");

  CHECK(refusal(good, 0) == "x.grid: " + std::to_string(good.size()) +
                                " records are still in the frontier: finish the grid with expand "
                                "--complete");
  RecordColumns without_last = good;
  const PointIndex last = 26;
  while (!without_last.point.empty() && without_last.point.back() == last) {
    without_last.point.pop_back();
    without_last.level.pop_back();
    without_last.generation.pop_back();
    without_last.rows.erase(without_last.rows.end() - 2, without_last.rows.end());
    without_last.links.erase(without_last.links.end() - kDirections, without_last.links.end());
  }
  CHECK(refusal(without_last) ==
        "x.grid: 1 grid points have no level: the seeds do not reach them, see verify");

  const PointIndex centre = box.index({1, 1, 1});
  const auto middle = static_cast<std::size_t>(
      std::find(good.point.begin(), good.point.end(), centre) - good.point.begin());
  for (const Level bad : {Level{2}, kUnsettled, kLeavesBox}) {
    RecordColumns columns = good;
    columns.links[middle * kDirections + 4] = bad;
    CHECK(refusal(columns) == "x.grid: 1 links lead to no record: the grid is damaged, see verify");
  }
  RecordColumns columns = good;
  columns.rows[middle * 2 + 1] = std::nan("");
  CHECK(refusal(columns) ==
        "x.grid: 1 records have a state, force or shape that is not finite, see verify");
}

TEST_CASE("a box whose points coincide in double precision is refused") {
  for (const Box& box : {Box{{1e16, 0, 0}, 0.5, {3, 3, 3}}, Box{{0, 0, 0}, 1e-310, {3, 3, 3}},
                         Box{{-1e308, 0, 0}, 1e308, {3, 1, 1}}}) {
    const Grid grid = random_grid(box, 1, 1, 1);
    CHECK_THROWS_AS(Traversal(grid), Error);
  }
}

TEST_CASE("a step allocates nothing") {
  const Box box{{0, 0, 0}, 1, {20, 20, 20}};
  const Grid grid = random_grid(box, 9, 3, 4);
  Traversal t(grid);
  std::mt19937_64 random(3);
  std::vector<Vec3> path(20000);
  for (Vec3& x : path)
    x = {uniform(random, -2, 22), uniform(random, -2, 22), uniform(random, -2, 22)};
  path[77] = {std::nan(""), 0, 0};
  std::uint64_t sum = 0;
  const std::uint64_t before = allocations();
  t.start(path[0]);
  for (const Vec3& x : path) sum += t.step(x).face_switches;
  const std::uint64_t after = allocations();
  CHECK(after == before);
  CHECK(sum > 0);
  // The counter counts.
  ::operator delete(::operator new(1));
  CHECK(allocations() > after);
}
