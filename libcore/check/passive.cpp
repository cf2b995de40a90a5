#include "libcore/check/passive.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "libcore/base/text.hpp"
#include "libcore/check/paths.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kMostShown = 12;  // links of a closed walk

/// A work, and the first configuration where it is largest.
struct LargestGain {
  double work = 0;
  Configuration where;
  void look_at(double other, const Configuration& configuration) {
    if (!(other > work)) return;
    work = other;
    where = configuration;
  }
};

struct InsideCells {
  LargestGain turn, mixture;
  void add(const InsideCells& later) {
    turn.look_at(later.turn.work, later.turn.where);
    mixture.look_at(later.mixture.work, later.mixture.where);
  }
};

class GainSurvey {
 public:
  GainSurvey(const Grid& grid, const Forces& forces, const Energy& energy)
      : grid_(grid), cells_(grid), forces_(forces), energy_(energy), pairs_(corner_pairs(cells_)) {}

  void look_at(const Configuration& configuration, InsideCells& seen) const {
    const Corners corners = corners_of(grid_, cells_, configuration);
    for (int a = 0; a < 3; ++a) {
      const int u = (a + 1) % 3, v = (a + 2) % 3;  // the axes of the face
      // Along a flat axis the face is a line, and its two edges are one.
      if (!cells_.is_corner(1 << u | 1 << v)) continue;
      for (int side = 0; side < 2; ++side) {
        const auto at = [&](int i, int j) -> const Vec3& {
          return forces_[corners.record[side << a | i << u | j << v]];
        };
        const double around = at(0, 0)[u] + at(1, 0)[u] + at(1, 0)[v] + at(1, 1)[v] - at(1, 1)[u] -
                              at(0, 1)[u] - at(0, 1)[v] - at(0, 0)[v];
        seen.turn.look_at(std::abs(around) * grid_.box().spacing / 2, configuration);
      }
    }
  }

  void look_at_mixture(const Configuration& configuration, InsideCells& seen) const {
    const Corners corners = corners_of(grid_, cells_, configuration);
    for (const CornerPair& pair : pairs_) {
      const RecordIndex linked = grid_.destination(corners.record[pair.a], pair.q);
      const RecordIndex there = corners.record[pair.b];
      if (linked == Grid::kNoRecord || linked == there) continue;
      if (energy_.part[linked] != energy_.part[there]) continue;
      seen.mixture.look_at(std::abs(energy_.potential[linked] - energy_.potential[there]),
                           configuration);
    }
  }

 private:
  const Grid& grid_;
  const Cells cells_;
  const Forces& forces_;
  const Energy& energy_;
  const std::vector<CornerPair> pairs_;
};

std::string unit_of_work(const Grid& grid) {
  const std::string& length = grid.spec().length_unit;
  return "N " + (length.empty() ? "lengths" : printable_line(length));
}

std::string describe(const Grid& grid, const ClosedWalk& walk) {
  std::string text = "gains " + rounded(walk.gain) + " " + unit_of_work(grid) + ", allowance " +
                     rounded(walk.allowance) + ", in " + std::to_string(walk.links.size()) +
                     " links from " + describe(grid, walk.links[0].from) + ": directions";
  for (std::size_t i = 0; i < std::min(walk.links.size(), kMostShown); ++i)
    text += " " + std::to_string(walk.links[i].q);
  return walk.links.size() > kMostShown ? text + " ..." : text;
}

Figure gain_per_length(const Grid& grid, const Energy& energy) {
  std::string where = energy.steepest.links.empty() ? "" : describe(grid, energy.steepest);
  if (!energy.is_steepest) where = "at least; " + where;
  return {"gain per length", energy.steepest.rate(), "N", where};
}

/// The most that a one-way link and the reversible way back cost, and work that is no number.
Figure look_at_links(const Grid& grid, const Work& work, const Energy& energy, Findings& found) {
  double loss = 0;
  Link lossy{0, 0};
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (int q = 0; q < kDirections; ++q) {
      const RecordIndex target = grid.destination(r, q);
      if (!work.takes(q) || target == Grid::kNoRecord) continue;
      ++found.counted;
      const double gain = work.gain({r, q});
      if (!std::isfinite(gain)) {
        found.offend(place_of(grid, r, q),
                     [&] { return describe_link(grid, r, q) + ": its work is not finite"; });
        continue;
      }
      // Between parts the potential has no common zero.
      if (energy.part[r] != energy.part[target] || work.is_reversible({r, q})) continue;
      const double lost = energy.potential[r] - energy.potential[target] - gain;
      if (!(lost > loss)) continue;
      loss = lost;
      lossy = {r, q};
    }
  return {"largest loss", loss, unit_of_work(grid),
          loss > 0 ? "one way by " + describe_link(grid, lossy.from, lossy.q) +
                         ", and back by reversible links"
                   : ""};
}

}  // namespace

Check check_passive(const Grid& grid, const Work& work, const Energy& energy) {
  Check check{"passive", "links", "closed walks that return energy to the hand", {}};
  const Figure loss = look_at_links(grid, work, energy, check.found);
  for (const ClosedWalk& walk : energy.gaining)
    check.found.offend(place_of(grid, walk.links.front().from),
                       [&] { return describe(grid, walk); });
  if (energy.gave_up && check.found.offenders == 0)
    check.not_proved =
        "the search for closed walks that gain energy was given up; try a part of the grid, or a "
        "smaller one, and look at the steepest walk below";
  check.figures = {gain_per_length(grid, energy), loss};
  return check;
}

void add_inside_cells(Check& check, const Grid& grid, const CellMap& map,
                      const Configurations& found, const Forces& forces, const Energy& energy,
                      int threads) {
  const GainSurvey survey(grid, forces, energy);
  const auto simple = [&](PointIndex base, InsideCells& seen) {
    if (map.exists(base) && map.is_simple(base)) survey.look_at({base, 0}, seen);
  };
  const auto listed = [&](const Configuration& configuration, InsideCells& seen) {
    survey.look_at(configuration, seen);
    survey.look_at_mixture(configuration, seen);
  };
  const auto inside = look_at_all<InsideCells>(grid, found, threads, simple, listed);
  const auto add = [&](const std::string& name, const LargestGain& l, const std::string& where) {
    check.figures.push_back(
        {name, l.work, unit_of_work(grid), l.work > 0 ? where + describe(grid, l.where) : ""});
  };
  add("largest turn", inside.turn, "around a face of ");
  add("largest mixture", inside.mixture, "between branches in ");
}

Check check_limited(const Grid& grid, const ForceLimit& limit, const Energy& energy) {
  Check check{"limited",
              "walks",
              "what a limit of " + rounded(limit.max_force) + " N at a gain of " +
                  rounded(limit.gain) +
                  " makes of this: closed walks that gain, for which the safety core's energy "
                  "promise pays",
              {},
              /*is_note=*/true};
  check.found.counted = energy.gaining.size();
  for (const ClosedWalk& walk : energy.gaining)
    check.found.offend(place_of(grid, walk.links.front().from),
                       [&] { return describe(grid, walk); });
  check.figures = {gain_per_length(grid, energy)};
  return check;
}

}  // namespace hapgrid
