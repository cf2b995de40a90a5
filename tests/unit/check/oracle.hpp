// What play can be in, found by play itself: the oracle of whatever is proved over all of it.
#pragma once

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libcore/check/report.hpp"
#include "libcore/haptic/paper_traversal.hpp"

namespace hapgrid::testing {

/// What one sees of the traversal from outside.
using Seen = std::pair<GridCoordinates, std::array<RecordIndex, 8>>;
inline Seen seen(const PaperTraversal& t) { return {t.cell(), t.records()}; }

inline std::uint32_t cells_along(const Box& box, int a) { return std::max(1u, box.counts[a] - 1); }

/// A position inside a cell, `part` of the way along each axis.
inline Vec3 inside(const Box& box, const GridCoordinates& cell, const Vec3& part) {
  Vec3 x = box.position(cell);
  for (int a = 0; a < 3; ++a)
    if (box.counts[a] > 1) x[a] += box.spacing * part[a];
  return x;
}

/// The oracle: the traversal itself, copied at each place that it has not been at before and sent
/// from there to all neighbours. Also what the notes should say of these places.
struct Oracle {
  std::map<Seen, PaperTraversal> at;
  std::uint64_t switches = 0, one_way = 0, one_way_switches = 0, blocked = 0;

  explicit Oracle(const Grid& grid) {
    const Box& box = grid.box();
    std::vector<const PaperTraversal*> todo;
    const auto visit = [&](const PaperTraversal& t) {
      const auto [where, is_new] = at.try_emplace(seen(t), t);
      if (is_new) todo.push_back(&where->second);
    };
    GridCoordinates cell;
    for (cell[2] = 0; cell[2] < cells_along(box, 2); ++cell[2])
      for (cell[1] = 0; cell[1] < cells_along(box, 1); ++cell[1])
        for (cell[0] = 0; cell[0] < cells_along(box, 0); ++cell[0])
          for (int octant = 0; octant < 8; ++octant) {
            Vec3 part;
            for (int a = 0; a < 3; ++a) part[a] = octant >> a & 1 ? 0.75 : 0.25;
            PaperTraversal t(grid);
            if (t.start(inside(box, cell, part)).usable())
              visit(t);
            else
              ++blocked;
          }
    for (std::size_t i = 0; i < todo.size(); ++i) {
      bool leaves_one_way = false;
      const GridCoordinates from = todo[i]->cell();
      for (int q = 0; q < kDirections; ++q) {
        const auto step = Direction(q).step();
        GridCoordinates to = from;
        bool exists = true;
        for (int a = 0; a < 3; ++a) {
          to[a] += static_cast<std::uint32_t>(step[a]);
          exists &= to[a] < cells_along(box, a);
        }
        if (!exists) continue;
        PaperTraversal t(*todo[i]);
        const StepResult there = t.step(inside(box, to, {0.5, 0.5, 0.5}));
        REQUIRE_FALSE(there.split);
        if (there.blocked) {
          ++blocked;
          continue;
        }
        ++switches;
        visit(t);
        const bool returned = t.step(inside(box, from, {0.5, 0.5, 0.5})).usable();
        if (returned && seen(t) != seen(*todo[i])) {
          leaves_one_way = true;
          ++one_way_switches;
        }
      }
      one_way += leaves_one_way;
    }
  }

  std::set<Seen> places() const {
    std::set<Seen> all;
    for (const auto& [place, t] : at) all.insert(place);
    return all;
  }
};

inline double figure(const Check& check, const std::string& name) {
  for (const Figure& f : check.figures)
    if (f.name == name) return f.value;
  return 0;
}

}  // namespace hapgrid::testing
