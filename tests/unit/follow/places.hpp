// Boxes and places in them where a traversal can go wrong, and what must hold wherever it is.
#pragma once

#include <memory>

#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/paper_traversal.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/follow/random_grid.hpp"

namespace hapgrid::testing {

inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kEps = std::numeric_limits<double>::epsilon();

using Cell = std::array<int, 3>;

inline double face(const Box& box, int axis, int c) {
  GridCoordinates at{0, 0, 0};
  at[axis] = static_cast<std::uint32_t>(c);
  return box.position(at)[axis];
}

/// Boxes whose coordinates round in different ways, some flat along an axis.
inline std::vector<Box> boxes() {
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
inline Vec3 random_point(const Box& box, std::mt19937_64& random) {
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
inline Vec3 random_point_in(const Box& box, const Cell& cell, std::mt19937_64& random) {
  Vec3 x;
  for (int a = 0; a < 3; ++a) {
    const double low = face(box, a, cell[a]);
    const double high = box.counts[a] > 1 ? face(box, a, cell[a] + 1) : low;
    const auto kind = random() % 6;
    x[a] = kind == 0 ? low : kind == 1 ? high : std::min(uniform(random, low, high), high);
  }
  return x;
}

inline std::unique_ptr<Traversal> by_rule(bool paper, const Grid& grid) {
  if (paper) return std::make_unique<PaperTraversal>(grid);
  return std::make_unique<BranchTraversal>(grid, std::make_shared<const BranchNodes>(grid));
}

inline std::vector<double> copy(std::span<const double> s) { return {s.begin(), s.end()}; }

inline Cell cell_of(const Traversal& t) {
  return {static_cast<int>(t.cell()[0]), static_cast<int>(t.cell()[1]),
          static_cast<int>(t.cell()[2])};
}

inline int switches(const StepResult& r) {
  return r.face_switches + r.edge_switches + r.vertex_switches;
}

/// The cell that x belongs to when the HIP comes from `from`, by trying all of them: of the closed
/// cells that hold x the nearest.
inline Cell cell_from(const Box& box, const Cell& from, const Vec3& x) {
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
inline void require_consistent(const Grid& grid, const PaperTraversal& t) {
  const Box& box = grid.box();
  for (int corner = 0; corner < 8; ++corner) {
    GridCoordinates c = t.cell();
    for (int a = 0; a < 3; ++a) c[a] += box.counts[a] > 1 ? corner >> a & 1 : 0;
    const bool is_inside = c[0] < box.counts[0] && c[1] < box.counts[1] && c[2] < box.counts[2];
    REQUIRE(is_inside);
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

}  // namespace hapgrid::testing
