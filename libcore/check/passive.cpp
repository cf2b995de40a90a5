#include "libcore/check/passive.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "libcore/base/text.hpp"
#include "libcore/check/energy.hpp"
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

std::string describe(const Grid& grid, const ClosedWalk& walk, const std::string& unit) {
  std::string text = "gains " + rounded(walk.gain) + " " + unit + ", allowance " +
                     rounded(walk.allowance) + ", in " + std::to_string(walk.links.size()) +
                     " links from " + describe(grid, walk.links[0].from) + ": directions";
  for (std::size_t i = 0; i < std::min(walk.links.size(), kMostShown); ++i)
    text += " " + std::to_string(walk.links[i].q);
  return walk.links.size() > kMostShown ? text + " ..." : text;
}

}  // namespace

Check check_passive(const Grid& grid, const CellMap& map, const Configurations& found,
                    const Forces& forces, int threads) {
  const std::string unit =
      "N " +
      (grid.spec().length_unit.empty() ? "lengths" : printable_line(grid.spec().length_unit));
  const Work work(grid, forces);
  const Energy energy = find_energy(grid, work, threads, Findings::kShown);

  Check check{"passive", "links", "closed walks that return energy to the hand", {}};
  double loss = 0;
  Link lossy{0, 0};
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (int q = 0; q < kDirections; ++q) {
      const RecordIndex target = grid.destination(r, q);
      if (target == Grid::kNoRecord) continue;
      ++check.found.counted;
      // Between parts the potential has no common zero.
      if (energy.part[r] != energy.part[target] || work.is_reversible({r, q})) continue;
      const double lost = energy.potential[r] - energy.potential[target] - work.gain({r, q});
      if (!(lost > loss)) continue;
      loss = lost;
      lossy = {r, q};
    }
  for (const ClosedWalk& walk : energy.gaining)
    check.found.offend([&] { return describe(grid, walk, unit); });
  if (energy.gave_up && energy.gaining.empty())
    check.found.offend([] { return "undecided: the search for them was given up"; });
  else if (energy.gave_up)
    check.meaning += " (more were not looked for)";
  check.figures.push_back({"largest loss", loss, unit,
                           loss > 0 ? "one way by " + describe_link(grid, lossy.from, lossy.q) +
                                          ", and back by reversible links"
                                    : ""});

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
        {name, l.work, unit, l.work > 0 ? where + describe(grid, l.where) : ""});
  };
  add("largest turn", inside.turn, "around a face of ");
  add("largest mixture", inside.mixture, "between branches in ");
  return check;
}

}  // namespace hapgrid
