// The traversal as the paper writes it: the oracle.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "tests/unit/follow/places.hpp"

namespace hapgrid::testing {

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

}  // namespace hapgrid::testing
