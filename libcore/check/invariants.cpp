#include "libcore/check/invariants.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/cell.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

bool is_finite(std::span<const double> state) {
  return std::all_of(state.begin(), state.end(), [](double v) { return std::isfinite(v); });
}

Check check_complete(const Grid& grid) {
  Check check{"complete", "records", "records that no expand has looked at (the frontier)", {}};
  check.found.counted = grid.records();
  for (RecordIndex r = 0; r < grid.records(); ++r)
    if (grid.in_frontier(r))
      check.found.offend(at_record(grid, r), [&] { return describe(grid, r); });
  return check;
}

Check check_coverage(const Grid& grid) {
  Check check{"coverage", "points", "points without a level", {}};
  check.found.counted = grid.box().points();
  for (std::uint64_t i = 0; i < grid.box().points(); ++i) {
    const auto p = static_cast<PointIndex>(i);
    if (grid.levels(p) == 0)
      check.found.offend({.point = p}, [&] { return describe(grid.box(), p); });
  }
  return check;
}

namespace {
/// What is wrong with the destination level of a link; empty when nothing is.
std::string link_fault(const Grid& grid, RecordIndex r, int q, bool is_inside) {
  const Level level = grid.links(r)[static_cast<std::size_t>(q)];
  if (!is_inside)
    return level == kLeavesBox
               ? ""
               : format("destination level {}, but the direction leaves the box", level);
  if (level == kLeavesBox) return "marked as leaving the box, but it stays inside";
  if (grid.in_frontier(r))
    return level == kUnsettled
               ? ""
               : format("destination level {}, but the record is in the frontier", level);
  if (level == kUnsettled) return "not settled, but the record is not in the frontier";
  if (grid.destination(r, q) != Grid::kNoRecord) return "";
  const auto target = static_cast<PointIndex>(grid.point(r) + grid.neighbourhood().offset(q));
  return format("destination level {}, but {} has {} levels", level, describe(grid.box(), target),
                grid.levels(target));
}
}  // namespace

Check check_links(const Grid& grid) {
  Check check{"links", "directions", "destination levels that cannot be", {}};
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    const DirectionMask inside = grid.neighbourhood().inside(grid.point(r));
    for (int q = 0; q < kDirections; ++q) {
      ++check.found.counted;
      const std::string fault = link_fault(grid, r, q, inside >> q & 1);
      if (!fault.empty())
        check.found.offend(at_link(grid, r, q),
                           [&] { return describe_link(grid, r, q) + ": " + fault; });
    }
  }
  return check;
}

Check check_finite(const Grid& grid) {
  Check check{"finite", "records", "rows with a number that is not finite", {}};
  check.found.counted = grid.records();
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    const auto row = grid.row(r);
    const auto bad =
        std::find_if_not(row.begin(), row.end(), [](double v) { return std::isfinite(v); });
    if (bad == row.end()) continue;
    check.found.offend(at_record(grid, r), [&] {
      const auto i = static_cast<std::size_t>(bad - row.begin());
      const bool in_state = i < grid.state_size();
      return format("{}: {} {} is {}", describe(grid, r), in_state ? "component" : "stored number",
                    in_state ? i : i - grid.state_size(), to_text(*bad));
    });
  }
  return check;
}

Check check_distinct(const Grid& grid, const Model& model) {
  Check check{"distinct",
              "pairs of levels",
              "levels of one point that are the same state under the tolerance function",
              {}};
  for (RecordIndex a = 0; a < grid.records(); ++a) {
    const PointIndex p = grid.point(a);
    for (RecordIndex b = a + 1; b < grid.first(p) + grid.levels(p); ++b) {
      ++check.found.counted;
      const auto one = grid.state(a), other = grid.state(b);
      if (!is_finite(one) || !is_finite(other) || !model.equal(one.data(), other.data())) continue;
      check.found.offend(at_record(grid, a), [&] {
        return format("{} and level {}: states {} and {}", describe(grid, a), grid.level(b),
                      state_text(one), state_text(other));
      });
    }
  }
  return check;
}

std::vector<std::uint32_t> find_distances(const Grid& grid) {
  std::vector<std::uint32_t> distance(grid.records(), kUnreached);
  // Breadth first: `reached` is the queue, and keeps what has left it.
  std::vector<RecordIndex> reached;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    if (grid.record_generation(r) != 0) continue;
    distance[r] = 0;
    reached.push_back(r);
  }
  for (std::size_t head = 0; head < reached.size(); ++head) {
    const RecordIndex r = reached[head];
    for (int q = 0; q < kDirections; ++q) {
      const RecordIndex target = grid.destination(r, q);
      if (target == Grid::kNoRecord || distance[target] != kUnreached) continue;
      distance[target] = distance[r] + 1;
      reached.push_back(target);
    }
  }
  return distance;
}

Check check_reachable(const Grid& grid, const std::vector<std::uint32_t>& distances) {
  Check check{"reachable", "records", "records that no chain of links leads to from the seeds", {}};
  check.found.counted = grid.records();
  for (RecordIndex r = 0; r < grid.records(); ++r)
    if (distances[r] == kUnreached)
      check.found.offend(at_record(grid, r), [&] { return describe(grid, r); });
  return check;
}

Check check_generations(const Grid& grid, const std::vector<std::uint32_t>& distances) {
  Check check{"generations",
              "records",
              "records whose generation is not their distance from the seeds, in links, or less "
              "than that of a level below",
              {}};
  std::uint32_t youngest = 0;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    const std::uint32_t generation = grid.record_generation(r);
    youngest = std::max(youngest, generation);
    if (distances[r] == kUnreached) continue;
    ++check.found.counted;
    const auto offend = [&](const char* beside, std::uint32_t other) {
      check.found.offend(at_record(grid, r), [&] {
        return format("{}: generation {}, {} {}", describe(grid, r), generation, beside, other);
      });
    };
    if (distances[r] != generation)
      offend("distance", distances[r]);
    else if (grid.level(r) > 0 && grid.record_generation(r - 1) > generation)
      offend("the level below has", grid.record_generation(r - 1));
  }
  // The last round finds nothing new.
  if (grid.records() > 0 && grid.generation() > youngest + 1)
    check.found.offend([&] {
      return format("the grid has generation {}, its youngest record {}", grid.generation(),
                    youngest);
    });
  return check;
}

namespace {

/// Whether the box has the cell in which a point is corner `corner`. Of a flat cell the lower
/// corner of two counts.
bool has_cell(const Box& box, PointIndex point, int corner) {
  const GridCoordinates c = box.coordinates(point);
  for (int a = 0; a < 3; ++a) {
    const bool is_upper = corner >> a & 1;
    if (box.counts[a] == 1 ? is_upper : is_upper ? c[a] == 0 : c[a] + 1 == box.counts[a])
      return false;
  }
  return true;
}

/// Finds whether the branch of record r has a node in all corners of the cell in which r is corner
/// `corner`. Counts the cell in `torn` where a node is a ghost.
void check_cell(const Grid& grid, const BranchNodes& branches, const Cells& cells, RecordIndex r,
                int corner, Findings& found, std::uint64_t& torn) {
  ++found.counted;
  bool is_torn = false;
  for (int k = 0; k < 8; ++k) {
    const int q = kBetweenCorners[corner][k];
    if (q < 0 || !cells.is_corner(k)) continue;
    const Node node = branches.node(r, q);
    if (node == BranchNodes::kNoNode)
      return found.offend(at_link(grid, r, q),
                          [&] { return describe_link(grid, r, q) + ": leads to no record"; });
    is_torn |= branches.is_ghost(node);
  }
  torn += is_torn;
}

}  // namespace

Check check_continuous(const Grid& grid, const BranchNodes& branches) {
  Check check{
      "continuous", "cells", "cells around a record in which its branch lacks a corner", {}};
  const Cells cells(grid);
  std::uint64_t torn = 0, mixed = 0;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    if (grid.in_frontier(r)) continue;
    for (int corner = 0; corner < 8; ++corner) {
      if (!has_cell(grid.box(), grid.point(r), corner)) continue;
      check_cell(grid, branches, cells, r, corner, check.found, torn);
      mixed += branches.is_mixed(r, corner);
    }
  }
  check.figures = {
      {"torn", static_cast<double>(torn), "", "of these cells: the branch ends in them"},
      {"mixed", static_cast<double>(mixed), "",
       "of these cells: two other corners are not of one branch themselves"},
      {"ghosts", static_cast<double>(branches.ghosts()), "",
       "extrapolated rows at points before which a branch ends"}};
  return check;
}

void require_playable(const Grid& grid, const std::string& name) {
  const auto refuse = [&](const Check& check, const char* what) {
    if (check.found.offenders > 0)
      throw Error(format("{}: {}{}", name, check.found.offenders, what));
  };
  refuse(check_complete(grid),
         " records are still in the frontier: finish the grid with expand --complete");
  refuse(check_coverage(grid),
         " grid points have no level: the seeds do not reach them, see verify");
  refuse(check_links(grid), " links lead to no record: the grid is damaged, see verify");
  refuse(check_finite(grid),
         " records have a state, force or shape that is not finite, see verify");
}

}  // namespace hapgrid
