#include "libcore/check/paths.hpp"

#include <bit>
#include <optional>
#include <utility>

#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

std::string describe_move(int q) {
  const auto step = Direction(q).step();
  return "(" + std::to_string(step[0]) + ", " + std::to_string(step[1]) + ", " +
         std::to_string(step[2]) + ")";
}

/// What one part of the configurations shows.
struct Seen {
  Findings paths, continuous, mixed, one_way;
  std::uint64_t one_way_switches = 0;
  std::uint64_t mixed_cells = 0;
  std::optional<PointIndex> first_mixed, last_mixed;  // their bases; cells ascend
  double gap = 0;
  Configuration widest;  // where the gap is
  int corner = 0;

  void add(Seen&& later) {
    paths.add(std::move(later.paths));
    continuous.add(std::move(later.continuous));
    mixed.add(std::move(later.mixed));
    one_way.add(std::move(later.one_way));
    one_way_switches += later.one_way_switches;
    mixed_cells += later.mixed_cells;
    if (last_mixed && last_mixed == later.first_mixed) --mixed_cells;  // a cell in both parts
    if (!first_mixed) first_mixed = later.first_mixed;
    if (later.last_mixed) last_mixed = later.last_mixed;
    if (!(later.gap > gap)) return;
    gap = later.gap;
    widest = later.widest;
    corner = later.corner;
  }
};

class Judge {
 public:
  Judge(const Grid& grid, const CellMap& map)
      : grid_(grid), cells_(grid), map_(map), pairs_(corner_pairs(cells_)) {}

  /// The starts in a cell, or the moves of a simple one.
  void look_at(PointIndex base, Seen& seen) const {
    if (!map_.exists(base)) return;
    if (map_.is_simple(base)) {
      ++seen.paths.counted;
      seen.continuous.counted += static_cast<std::uint64_t>(std::popcount(map_.moves(base)));
      return;
    }
    for (int nearest = 0; nearest < 8; ++nearest) {
      Corners corners;
      if (!cells_.is_corner(nearest) || cells_.start(base, nearest, corners)) continue;
      const PointIndex point = cells_.point(base, nearest);
      if (grid_.levels(point) == 0) continue;
      const RecordIndex from = grid_.first(point);
      for (const auto& [a, b, q] : pairs_) {
        if (a != nearest || !is_missing(from, q)) continue;
        seen.paths.offend(place_of(grid_, from, q), [&, q = q] {
          // clang 14 captures no structured binding
          return "start in " + describe_cell(base) + " needs " + describe_link(grid_, from, q);
        });
        break;
      }
    }
  }

  void look_at(const Configuration& configuration, Seen& seen) const {
    ++seen.paths.counted;
    ++seen.one_way.counted;
    ++seen.mixed.counted;
    const Corners corners = corners_of(grid_, cells_, configuration);
    look_for_mixture(configuration, corners, seen);
    const DirectionMask moves = map_.moves(configuration.base);
    std::uint64_t one_way = 0;
    int first_one_way = 0;
    for (int q = 0; q < kDirections; ++q) {
      if (!(moves >> q & 1)) continue;
      const auto base = static_cast<PointIndex>(configuration.base + offset(q));
      Corners reached, back;
      bool changed = false;
      if (!cells_.cross(q, base, corners, reached, changed)) {
        look_for_missing(configuration, corners, q, seen);
        continue;
      }
      ++seen.continuous.counted;
      if (!keeps_vertices(configuration.base, corners, base, reached))
        seen.continuous.offend({configuration.base, {}, {}}, [&] {
          return describe(grid_, configuration) + " to " +
                 describe(grid_, configuration_of(base, reached));
        });
      const int opposite = Direction(q).opposite().q();
      if (cells_.cross(opposite, configuration.base, reached, back, changed) &&
          back.record != corners.record && one_way++ == 0)
        first_one_way = q;
    }
    seen.one_way_switches += one_way;
    if (one_way > 0)
      seen.one_way.offend({configuration.base, {}, {}}, [&] {
        return describe(grid_, configuration) + ", there and back in " +
               describe_move(first_one_way);
      });
  }

 private:
  std::int64_t offset(int q) const { return grid_.neighbourhood().offset(q); }
  std::string describe_cell(PointIndex base) const {
    const GridCoordinates c = map_.coordinates(base);
    return "cell (" + std::to_string(c[0]) + ", " + std::to_string(c[1]) + ", " +
           std::to_string(c[2]) + ")";
  }
  /// Whether a link that play needs leads nowhere and is not just waiting for an expand.
  bool is_missing(RecordIndex r, int q) const {
    return grid_.destination(r, q) == Grid::kNoRecord &&
           !(grid_.in_frontier(r) && grid_.links(r)[q] == kUnsettled);
  }

  void look_for_missing(const Configuration& configuration, const Corners& corners, int q,
                        Seen& seen) const {
    for (int corner = 0; corner < 8; ++corner) {
      const int towards = kCellSwitches[q].direction[corner];
      if (towards == CellSwitch::kKept) continue;
      const RecordIndex from = corners.record[kCellSwitches[q].from[corner]];
      if (!is_missing(from, towards)) continue;
      return seen.paths.offend(place_of(grid_, from, towards), [&] {
        return describe(grid_, configuration) + " to its neighbour in " + describe_move(q) +
               " needs " + describe_link(grid_, from, towards);
      });
    }
  }

  void look_for_mixture(const Configuration& configuration, const Corners& corners,
                        Seen& seen) const {
    bool is_mixed = false;
    for (const auto& [a, b, q] : pairs_) {
      const RecordIndex linked = grid_.destination(corners.record[a], q);
      if (linked == Grid::kNoRecord || linked == corners.record[b]) continue;
      is_mixed = true;
      const double gap =
          distance(grid_.spec().equality, grid_.state_size(), grid_.state(linked).data(),
                   grid_.state(corners.record[b]).data());
      if (!(gap > seen.gap)) continue;
      seen.gap = gap;
      seen.widest = configuration;
      seen.corner = b;
    }
    if (!is_mixed) return;
    seen.mixed.offend({configuration.base, {}, {}}, [&] { return describe(grid_, configuration); });
    seen.mixed_cells += seen.last_mixed != configuration.base;
    seen.last_mixed = configuration.base;
    if (!seen.first_mixed) seen.first_mixed = seen.last_mixed;
  }

  /// Each corner's record is at the corner's point, and the same where the cells have that in
  /// common.
  bool keeps_vertices(PointIndex from, const Corners& before, PointIndex to,
                      const Corners& after) const {
    for (int b = 0; b < 8; ++b) {
      const PointIndex point = cells_.point(to, b);
      if (grid_.point(after.record[b]) != point) return false;
      for (int a = 0; a < 8; ++a)
        if (cells_.point(from, a) == point && before.record[a] != after.record[b]) return false;
    }
    return true;
  }

  const Grid& grid_;
  const Cells cells_;
  const CellMap& map_;
  const std::vector<CornerPair> pairs_;
};

}  // namespace

std::string describe(const Grid& grid, const Configuration& configuration) {
  const GridCoordinates c = grid.box().coordinates(configuration.base);
  std::string text = "cell (" + std::to_string(c[0]) + ", " + std::to_string(c[1]) + ", " +
                     std::to_string(c[2]) + ") with levels";
  for (int corner = 0; corner < 8; ++corner)
    text += " " + std::to_string(configuration.levels >> (8 * corner) & 0xff);
  return text;
}

std::vector<Check> check_paths(const Grid& grid, const CellMap& map, const Configurations& found,
                               int threads) {
  const Judge judge(grid, map);
  const auto look_at = [&](const auto& what, Seen& seen) { judge.look_at(what, seen); };
  Seen seen = look_at_all<Seen>(grid, found, threads, look_at, look_at);
  // Those of simple cells are neither mixed nor one-way: there is one level at each corner.
  seen.mixed.counted = seen.one_way.counted = seen.paths.counted;

  Check paths{"paths", "configurations", "starts and switches of play that need a missing link",
              std::move(seen.paths)};
  if (found.gave_up)
    paths.not_proved = "more than " + std::to_string(found.listed.size()) +
                       " configurations were found, and the search was given up; by --traversal "
                       "branch nothing has to be searched";
  Check continuous{"continuous", "switches",
                   "switches of play that do not keep the common vertices",
                   std::move(seen.continuous)};
  Check mixed{"mixed", "configurations",
              "configurations of play with corners whose own links disagree", std::move(seen.mixed),
              true};
  if (seen.mixed_cells > 0)
    mixed.figures.push_back({"cells", static_cast<double>(seen.mixed_cells), "",
                             "that have such a configuration, of " + std::to_string(map.cells())});
  if (seen.gap > 0)
    mixed.figures.push_back(
        {"largest gap", seen.gap, distance_unit(grid.spec()),
         "at " + describe(grid.box(), Cells(grid).point(seen.widest.base, seen.corner)) + ", in " +
             describe(grid, seen.widest)});
  Check one_way{"one-way", "configurations",
                "configurations of play that some switch leaves without a way straight back",
                std::move(seen.one_way), true};
  if (seen.one_way_switches > 0)
    one_way.figures.push_back(
        {"switches", static_cast<double>(seen.one_way_switches), "", "that cannot be taken back"});
  return {std::move(paths), std::move(continuous), std::move(mixed), std::move(one_way)};
}

}  // namespace hapgrid
