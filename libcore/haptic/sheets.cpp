#include "libcore/haptic/sheets.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "libcore/base/parallel.hpp"

namespace hapgrid {

namespace {

using Step = std::array<int, 3>;

/// The direction of a step, or -1 where it is none or leaves the cube of the 26 neighbours.
int direction_of(const Step& step) {
  const bool is_near =
      std::all_of(step.begin(), step.end(), [](int s) { return s >= -1 && s <= 1; });
  if (!is_near || step == Step{0, 0, 0}) return -1;
  return Direction::of(step[0], step[1], step[2]).q();
}

Step minus(const Step& a, const Step& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// What blocks of points list, joined.
template <class Item>
struct Listed {
  std::vector<Item> items;
  void add(Listed&& later) {
    if (items.empty())
      items = std::move(later.items);
    else
      items.insert(items.end(), later.items.begin(), later.items.end());
  }
};

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

Sheets::Sheets(const Grid& grid) : grid_(grid), row_size_(grid.spec().row_size()) {
  const std::vector<End> ends = find_ends();
  for (std::size_t i = 0; i < ends.size();) {
    std::size_t end = i;
    while (end < ends.size() && ends[end].point == ends[i].point) ++end;
    add_ghosts(std::span(ends).subspan(i, end - i));
    i = end;
  }
  find_mixed_records();
}

/// All one-way links, ascending by the point to which they lead.
std::vector<Sheets::End> Sheets::find_ends() {
  std::vector<End> found =
      std::move(sum_of_points<Listed<End>>(
                    grid_.tangled(), all_threads(),
                    [&](PointIndex p, Listed<End>& ends) {
                      for (RecordIndex l = 0; l < grid_.levels(p); ++l) {
                        const LinksOfRecord links(grid_, p, static_cast<Level>(l));
                        for (int q = 0; q < kDirections; ++q)
                          if (links.is_one_way(q))
                            ends.items.push_back(
                                {static_cast<PointIndex>(p + grid_.neighbourhood().offset(q)),
                                 grid_.first(p) + l, static_cast<std::uint8_t>(q)});
                      }
                    })
                    .items);
  std::vector<std::uint64_t> has_ends(grid_.records() / 64 + 1);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const RecordIndex r = found[i].from;
    if (i == 0 || r != found[i - 1].from) ends_.push_back({0, static_cast<std::uint32_t>(i)});
    ends_.back().one_way |= DirectionMask{1} << found[i].q;
    has_ends[r / 64] |= std::uint64_t{1} << r % 64;
  }
  has_ends_ = RankedBits(has_ends);
  ghost_of_.assign(found.size(), kNoNode);
  std::stable_sort(found.begin(), found.end(),
                   [](const End& a, const End& b) { return a.point < b.point; });
  return found;
}

void Sheets::find_mixed_records() {
  struct Mixed {
    RecordIndex record;
    std::uint8_t corners;
  };
  const auto found = sum_of_points<Listed<Mixed>>(
      grid_.tangled(), all_threads(), [&](PointIndex p, Listed<Mixed>& mixed) {
        for (RecordIndex l = 0; l < grid_.levels(p); ++l)
          if (const auto corners = find_mixed(p, static_cast<Level>(l)); corners != 0)
            mixed.items.push_back({grid_.first(p) + l, corners});
      });
  std::vector<std::uint64_t> is_mixed(grid_.records() / 64 + 1);
  for (const Mixed& mixed : found.items) {
    is_mixed[mixed.record / 64] |= std::uint64_t{1} << mixed.record % 64;
    mixed_.push_back(mixed.corners);
  }
  is_mixed_ = RankedBits(is_mixed);
}

/// Of the branches that end before one point: one ghost each. Two links belong to one branch where
/// two-way links between such records connect them; a way round by other records does not count,
/// because the sheet can have a cut there.
void Sheets::add_ghosts(std::span<const End> ends) {
  std::vector<std::uint32_t> parent(ends.size());
  std::iota(parent.begin(), parent.end(), 0U);
  for (std::uint32_t i = 0; i < ends.size(); ++i)
    for (std::uint32_t j = i + 1; j < ends.size(); ++j) {
      // Both steps lead to the same point.
      const int q = direction_of(minus(Direction(ends[i].q).step(), Direction(ends[j].q).step()));
      if (q >= 0 && node(ends[i].from, q) == ends[j].from)
        parent[root_of(parent, i)] = root_of(parent, j);
    }
  std::vector<std::uint32_t> branch(ends.size());
  for (std::uint32_t i = 0; i < ends.size(); ++i) branch[i] = root_of(parent, i);
  for (std::uint32_t i = 0; i < ends.size(); ++i)
    if (branch[i] == i) add_ghost(ends, branch, i);
}

/// Extrapolates along each link that goes on behind its record: through three records where there
/// are so many, since states bend most where branches end, else through two. Where none goes on,
/// the mean of the records has to do.
void Sheets::add_ghost(std::span<const End> ends, const std::vector<std::uint32_t>& branch,
                       std::uint32_t which) {
  const Node ghost = grid_.records() + ghosts();
  std::vector<double> row(row_size_), mean(row_size_);
  double weights = 0, members = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (branch[i] != which) continue;
    const End& end = ends[i];
    ghost_of_[ends_of(end.from)->number(end.q)] = ghost;
    ghost_ends_.push_back({end.from, end.q});
    const int back = Direction(end.q).opposite().q();
    const double* const r0 = grid_.row(end.from).data();
    const double* const r1 = two_way_row(end.from, back);
    const double* const r2 = r1 ? two_way_row(grid_.destination(end.from, back), back) : nullptr;
    const Step d = Direction(end.q).step();
    const double weight = r1 ? 1.0 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) : 0;
    for (std::size_t c = 0; c < row_size_; ++c) {
      mean[c] += r0[c];
      if (r1) row[c] += weight * (r2 ? 3 * (r0[c] - r1[c]) + r2[c] : 2 * r0[c] - r1[c]);
    }
    weights += weight;
    ++members;
  }
  for (std::size_t c = 0; c < row_size_; ++c)
    ghost_rows_.push_back(weights > 0 ? row[c] / weights : mean[c] / members);
  ghost_points_.push_back(ends.front().point);
  ghost_first_.push_back(static_cast<std::uint32_t>(ghost_ends_.size()));
}

/// The row where a link leads, if it is two-way.
const double* Sheets::two_way_row(RecordIndex r, int q) const {
  const RecordIndex to = grid_.destination(r, q);
  return to == Grid::kNoRecord || (one_way(r) >> q & 1) ? nullptr : grid_.row(to).data();
}

Sheets::View Sheets::view(Node node) const noexcept {
  if (node == kNoNode || is_ghost(node)) return {};
  return {grid_.links(node).data(), one_way(node), grid_.level(node)};
}

std::array<std::uint8_t, 8> Sheets::apart(const std::array<View, 8>& corners) noexcept {
  std::array<std::uint8_t, 8> pairs{};
  for (int a = 0; a < 8; ++a)
    for (int b = a + 1; corners[a].links && b < 8; ++b) {
      const int q = kBetweenCorners[a][b];
      if (corners[b].links && ((corners[a].one_way >> q & 1) ||  // then a ghost is there
                               corners[a].links[q] != corners[b].level))
        pairs[a] |= static_cast<std::uint8_t>(1 << b);
    }
  return pairs;
}

std::array<std::uint8_t, 8> Sheets::apart(const std::array<Node, 8>& corners) const noexcept {
  std::array<View, 8> views;
  for (int k = 0; k < 8; ++k) views[k] = view(corners[k]);
  return apart(views);
}

std::uint8_t Sheets::find_mixed(PointIndex p, Level level) const {
  const RecordIndex r = grid_.first(p) + level;
  const DirectionMask inside = grid_.neighbourhood().inside(p), ends = one_way(r);
  const View own{grid_.links(r).data(), ends, level};
  std::array<View, kDirections> neighbour{};
  bool is_alone = true;        // around it points have one level
  DirectionMask other = ends;  // where not all links lead to its own level number
  for (int q = 0; q < kDirections; ++q) {
    if (!(inside >> q & 1)) continue;
    is_alone &= !(ends >> q & 1);
    const auto point = static_cast<PointIndex>(p + grid_.neighbourhood().offset(q));
    const Level there = own.links[q];
    if ((ends >> q & 1) || there >= grid_.levels(point)) continue;
    const RecordIndex to = grid_.first(point) + there;
    neighbour[q] = {grid_.links(to).data(), one_way(to), there};
    is_alone &= grid_.levels(point) == 1;
    if (there != level || !grid_.links_lead_to(to, level)) other |= DirectionMask{1} << q;
  }
  std::uint8_t mixed = 0;
  if (is_alone) return mixed;  // its neighbours can only be linked to each other
  for (int corner = 0; corner < 8; ++corner) {
    std::array<View, 8> corners;
    bool is_plain = true;
    for (int k = 0; k < 8; ++k) {
      const int q = kBetweenCorners[corner][k];
      corners[k] = k == corner ? own : neighbour[q];
      is_plain &= k == corner || !(other >> q & 1);
    }
    if (!is_plain && apart(corners) != std::array<std::uint8_t, 8>{})
      mixed |= static_cast<std::uint8_t>(1 << corner);
  }
  return mixed;
}

}  // namespace hapgrid
