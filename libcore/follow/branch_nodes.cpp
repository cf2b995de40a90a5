#include "libcore/follow/branch_nodes.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace hapgrid {

namespace {

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

BranchNodes::BranchNodes(const Grid& grid) : grid_(grid), row_size_(grid.spec().row_size()) {
  const std::vector<OneWayLink> links = find_one_way_links();
  for (std::size_t i = 0; i < links.size();) {
    std::size_t end = i;
    while (end < links.size() && links[end].point == links[i].point) ++end;
    add_ghosts(std::span(links).subspan(i, end - i));
    i = end;
  }
  mixed_.resize(grid.records());
  has_one_branch_.resize(grid.records());
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    mixed_[r] = find_mixed(r);
    has_one_branch_[r] = one_way_[r] == 0 && mixed_[r] == 0;
  }
}

/// All one-way links, ascending by the point to which they lead, and then by record.
std::vector<BranchNodes::OneWayLink> BranchNodes::find_one_way_links() {
  std::vector<OneWayLink> found;
  one_way_.resize(grid_.records());
  first_link_.resize(grid_.records());
  for (RecordIndex r = 0; r < grid_.records(); ++r) {
    first_link_[r] = static_cast<std::uint32_t>(found.size());
    for (int q = 0; q < kDirections; ++q) {
      if (!grid_.is_one_way(r, q)) continue;
      one_way_[r] |= DirectionMask{1} << q;
      const auto to = static_cast<PointIndex>(grid_.point(r) + grid_.neighbourhood().offset(q));
      found.push_back({to, r, static_cast<std::uint8_t>(q)});
    }
  }
  ghost_of_.assign(found.size(), kNoNode);
  std::stable_sort(found.begin(), found.end(),
                   [](const OneWayLink& a, const OneWayLink& b) { return a.point < b.point; });
  return found;
}

/// Of the branches that end before one point: one ghost each. Two links belong to one branch where
/// two-way links between their records connect them; a way round by other records does not count,
/// because the branch can have a cut there.
void BranchNodes::add_ghosts(std::span<const OneWayLink> links) {
  std::vector<std::uint32_t> parent(links.size());
  std::iota(parent.begin(), parent.end(), 0U);
  for (std::uint32_t i = 0; i < links.size(); ++i)
    for (int q = 0; q < kDirections; ++q) {
      // No record has two links into one point, so at most one of those behind is the neighbour.
      const RecordIndex to = two_way(links[i].from, q);
      const auto found = std::lower_bound(
          links.begin() + i + 1, links.end(), to,
          [](const OneWayLink& link, RecordIndex record) { return link.from < record; });
      if (found != links.end() && found->from == to)
        parent[root_of(parent, i)] =
            root_of(parent, static_cast<std::uint32_t>(found - links.begin()));
    }
  std::vector<std::uint32_t> order(links.size());  // the links, one branch after the other
  std::iota(order.begin(), order.end(), 0U);
  for (std::uint32_t i = 0; i < links.size(); ++i) parent[i] = root_of(parent, i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return parent[a] < parent[b]; });
  std::vector<OneWayLink> branch;
  for (std::size_t i = 0; i < order.size(); ++i) {
    branch.push_back(links[order[i]]);
    if (i + 1 < order.size() && parent[order[i + 1]] == parent[order[i]]) continue;
    add_ghost(branch);
    branch.clear();
  }
}

/// Extrapolates along each link that goes on behind its record: through three records where there
/// are so many, since states bend most where branches end, else through two. Where none goes on,
/// the mean of the records has to do.
void BranchNodes::add_ghost(std::span<const OneWayLink> links) {
  const Node ghost = grid_.records() + ghosts();
  std::vector<double> row(row_size_), mean(row_size_);
  double weights = 0;
  for (const OneWayLink& link : links) {
    ghost_of_[link_number(link.from, link.q)] = ghost;
    const int back = Direction(link.q).opposite().q();
    const RecordIndex behind = two_way(link.from, back);
    const RecordIndex farther = behind == Grid::kNoRecord ? Grid::kNoRecord : two_way(behind, back);
    const bool has_two = behind != Grid::kNoRecord, has_three = farther != Grid::kNoRecord;
    const double* const r0 = grid_.row(link.from).data();
    const double* const r1 = has_two ? grid_.row(behind).data() : nullptr;
    const double* const r2 = has_three ? grid_.row(farther).data() : nullptr;
    const auto d = Direction(link.q).step();
    const double weight = has_two ? 1.0 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) : 0;
    for (std::size_t c = 0; c < row_size_; ++c) {
      const auto near = [&](double value) {  // with an angle, on the same turn in all records
        return nearest(grid_.spec().equality, c, value, grid_.row(links.front().from)[c]);
      };
      const double s0 = near(r0[c]);
      mean[c] += s0;
      if (!has_two) continue;
      const double s1 = near(r1[c]);
      row[c] += weight * (has_three ? 3 * (s0 - s1) + near(r2[c]) : 2 * s0 - s1);
    }
    weights += weight;
  }
  for (std::size_t c = 0; c < row_size_; ++c)
    ghost_rows_.push_back(weights > 0 ? row[c] / weights
                                      : mean[c] / static_cast<double>(links.size()));
  ghost_links_.insert(ghost_links_.end(), links.begin(), links.end());
  ghost_first_.push_back(static_cast<std::uint32_t>(ghost_links_.size()));
}

std::array<std::uint8_t, 8> BranchNodes::apart(const std::array<Node, 8>& corners) const noexcept {
  std::array<std::uint8_t, 8> pairs{};
  std::array<bool, 8> is_record;
  std::array<Level, 8> level;
  for (int k = 0; k < 8; ++k) {
    is_record[k] = corners[k] != kNoNode && !is_ghost(corners[k]);
    level[k] = is_record[k] ? grid_.level(corners[k]) : Level{0};
  }
  for (int a = 0; a < 8; ++a) {
    if (!is_record[a]) continue;
    const auto links = grid_.links(corners[a]);
    for (int b = a + 1; b < 8; ++b) {
      const int q = kBetweenCorners[a][b];
      if (is_record[b] && ((one_way(corners[a]) >> q & 1) || links[q] != level[b]))
        pairs[a] |= static_cast<std::uint8_t>(1 << b);
    }
  }
  return pairs;
}

std::uint8_t BranchNodes::find_mixed(RecordIndex r) const {
  const PointIndex p = grid_.point(r);
  const DirectionMask inside = grid_.neighbourhood().inside(p);
  bool has_one_level = one_way_[r] == 0;  // the points to which its links lead have one level
  for (int q = 0; q < kDirections && has_one_level; ++q) {
    if (!(inside >> q & 1)) continue;
    const auto to = static_cast<PointIndex>(p + grid_.neighbourhood().offset(q));
    has_one_level = grid_.levels(to) == 1 || grid_.links(r)[q] >= grid_.levels(to);
  }
  if (has_one_level) return 0;  // its neighbours can only be linked to each other
  std::array<Node, kDirections> neighbour{};
  for (int q = 0; q < kDirections; ++q) neighbour[q] = node(r, q);
  std::uint8_t mixed = 0;
  for (int corner = 0; corner < 8; ++corner) {
    std::array<Node, 8> corners;
    for (int k = 0; k < 8; ++k)
      corners[k] = k == corner ? r : neighbour[kBetweenCorners[corner][k]];
    if (apart(corners) != std::array<std::uint8_t, 8>{})
      mixed |= static_cast<std::uint8_t>(1 << corner);
  }
  return mixed;
}

}  // namespace hapgrid
