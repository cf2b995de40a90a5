#include "tools/stats/branches.hpp"

#include <algorithm>
#include <numeric>

#include "libcore/base/format.hpp"

namespace hapgrid {

RecordIndex Branches::record(const Grid& grid, std::uint32_t branch, PointIndex point) const {
  for (RecordIndex r = grid.first(point); r < grid.first(point) + grid.levels(point); ++r)
    if (of_record[r] == branch) return r;
  return Grid::kNoRecord;
}

Branches find_branches(const Grid& grid) {
  Branches found;
  found.of_record.assign(grid.records(), Branches::kNone);
  std::vector<std::uint32_t> last_at(grid.box().points(), Branches::kNone);  // by point
  std::vector<RecordIndex> members;
  for (RecordIndex seed = 0; seed < grid.records(); ++seed) {
    if (found.of_record[seed] != Branches::kNone) continue;
    const auto branch = static_cast<std::uint32_t>(found.sizes.size());
    members.clear();
    const auto add = [&](RecordIndex r) {
      found.of_record[r] = last_at[grid.point(r)] = branch;
      members.push_back(r);
    };
    add(seed);
    for (std::size_t i = 0; i < members.size(); ++i)
      for (int q = 0; q < kDirections; ++q) {
        const RecordIndex to = grid.destination(members[i], q);
        if (to == Grid::kNoRecord || found.of_record[to] != Branches::kNone) continue;
        if (last_at[grid.point(to)] == branch) continue;
        if (grid.destination(to, Direction(q).opposite().q()) == members[i]) add(to);
      }
    found.sizes.push_back(static_cast<RecordIndex>(members.size()));
  }
  return found;
}

std::string branch_text(const Branches& branches, std::uint32_t branch) {
  constexpr std::size_t kShown = 8;
  std::vector<std::uint32_t> largest(branches.sizes.size());
  std::iota(largest.begin(), largest.end(), 0U);
  std::stable_sort(largest.begin(), largest.end(), [&](std::uint32_t a, std::uint32_t b) {
    return branches.sizes[a] > branches.sizes[b];
  });
  if (largest.size() > kShown) largest.resize(kShown);
  std::string text = format("branch {} of {}: {} records; the largest:", branch,
                            branches.sizes.size(), branches.sizes[branch]);
  for (const std::uint32_t b : largest)
    text += format("{} {} ({})", b == largest.front() ? "" : ",", b, branches.sizes[b]);
  return text + "\n";
}

}  // namespace hapgrid
