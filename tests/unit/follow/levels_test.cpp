// Which levels a traversal follows, against the paper's text.

#include "tests/unit/catch.hpp"
#include "tests/unit/follow/places.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

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

}  // namespace

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
