#include "libcore/follow/branch_traversal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hapgrid {

namespace {

// How much less the corners of another anchor must disagree, so that a HIP at rest between two of
// them does not change it again and again.
constexpr double kBetter = 0.05;
// Added to each corner's weight, so that a corner with weight 0 still counts.
constexpr double kLeastWeight = 0.02;
// How often the state can snap at one place. Snaps that go in a circle must end.
constexpr int kMostSnaps = 4;

/// In spacings squared.
double distance2(const Vec3& part, int corner) {
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    const double d = part[a] - (corner >> a & 1);
    sum += d * d;
  }
  return sum;
}

/// How much corners that are not of one branch contradict each other at the HIP: the sum, over such
/// pairs, of the product of their weights in the blend.
/// @param apart BranchNodes::apart()
double disagreement(const std::array<std::uint8_t, 8>& apart,
                    const std::array<double, 8>& weights) noexcept {
  double sum = 0;
  for (int a = 0; a < 8; ++a)
    for (int b = a + 1; apart[a] != 0 && b < 8; ++b)
      if (apart[a] >> b & 1) sum += (weights[a] + kLeastWeight) * (weights[b] + kLeastWeight);
  return sum;
}

}  // namespace

BranchTraversal::BranchTraversal(const Grid& grid, std::shared_ptr<const BranchNodes> branches,
                                 std::uint16_t most_parts)
    : Traversal(grid, most_parts),
      branches_(std::move(branches)),
      offset_(row_.size(), grid.box().spacing),
      missing_(row_.size()),
      expected_(row_.size()) {
  candidates_.reserve(kMostCandidates);
  for (BesideAnswer& answer : kept_) answer.row.resize(row_.size());
}

const StepResult& BranchTraversal::start(const Vec3& hip, Level level) noexcept {
  const std::optional<int> nearest = begin_start(hip);
  if (!nearest) return step_;
  const bool has_begun = take(*nearest, level, /*chosen=*/false);
  if (has_begun) {
    if (beside_) follow_model();
    evaluate();
  }
  return end_start(has_begun);
}

const StepResult& BranchTraversal::step(const Vec3& hip, bool next) noexcept {
  if (!has_started_) return start(hip, 0);
  if (!begin_step(hip)) return step_;
  while (const auto way = walk_.next()) {
    if (way->q >= 0 && !cross(*way)) {
      step_.blocked = true;
      break;
    }
    offset_.fade(position(), way->to);
    walk_.go(*way);
    arrive();
    // With a model beside the grid the decision waits for it, unless more cells follow.
    if ((!beside_ || walk_.is_split()) && decide_by_grid()) note_snap();
  }
  if (!step_.blocked) {
    if (next) {
      const int corner = walk_.nearest_corner();
      choose_next(corner, levels()[corner],
                  [&](Level level) { return take(corner, level, /*chosen=*/true); });
    }
    if (beside_) follow_model();
  }
  evaluate();
  return end_step();
}

/// The corner nearest to the HIP gets the level, and the others are of its branch. False when a
/// link or the level is missing, or when the hand chose this level and its branch ends before
/// position(): then nothing changes.
bool BranchTraversal::take(int nearest, Level level, bool chosen) noexcept {
  const PointIndex p = walk_.cells().point(walk_.base(), nearest);
  Branch branch;
  if (level >= grid_.levels(p) || !derive(walk_.base(), grid_.first(p) + level, nearest, branch))
    return false;
  if (chosen && branch.is_torn && has_ended(branch.nodes, corner_weights(part()))) return false;
  enter_branch(branch);
  offset_.end();
  arrive();
  if (!beside_) decide_by_grid();  // of which nobody is told: the state jumps here in any case
  return true;
}

void BranchTraversal::arrive() noexcept {
  part_ = part();
  weights_ = corner_weights(part_);
}

bool BranchTraversal::derive(PointIndex base, RecordIndex anchor, int corner,
                             Branch& branch) const noexcept {
  branch.anchor = walk_.cells().distinct(corner);
  branch.is_torn = false;
  branch.is_mixed = branches_->is_mixed(anchor, branch.anchor);
  const auto links = grid_.links(anchor);
  const DirectionMask one_way = branches_->one_way(anchor);
  branch.nodes[corner] = anchor;
  for (int other = 1; other < 8; ++other) {
    const int k = corner ^ other;
    const int q = kBetweenCorners[branch.anchor][walk_.cells().distinct(k)];
    branch.nodes[k] = q < 0              ? anchor
                      : one_way >> q & 1 ? branches_->node(anchor, q)
                                         : walk_.cells().destination(links, q, base, k);
    if (branch.nodes[k] == BranchNodes::kNoNode) return false;
    branch.is_torn |= branches_->is_ghost(branch.nodes[k]);
  }
  if (!branch.is_mixed) return true;
  std::array<Node, 8> corners = branch.nodes;
  for (int k = 0; k < 8; ++k)
    if (!walk_.cells().is_corner(k)) corners[k] = BranchNodes::kNoNode;
  branch.apart = branches_->apart(corners);
  return true;
}

void BranchTraversal::enter_branch(const Branch& branch) noexcept {
  anchor_ = branch.anchor;
  nodes_ = branch.nodes;
  is_torn_ = branch.is_torn;
  is_mixed_ = branch.is_mixed;
  apart_ = branch.apart;
  for (int k = 0; k < 8; ++k) {
    rows_[k] = branches_->row(nodes_[k]);
    __builtin_prefetch(rows_[k]);
    __builtin_prefetch(rows_[k] + row_.size() - 1);
  }
}

/// Changes to the branch's corners in the next cell. False when a link is missing: then nothing
/// changes.
bool BranchTraversal::cross(const CellWalk::Part& way) noexcept {
  const CellSwitch& move = kCellSwitches[way.q];
  const int beside = (anchor_ & ~move.moved) | (move.side & move.moved);
  if (!is_torn_ && !is_mixed_ && branches_->has_one_branch_around(nodes_[beside]))
    return cross_on_one_branch(way, beside, move);
  Branch next;
  // On the common face, edge or vertex.
  const Vec3 part = walk_.part_of_cell(walk_.nearest_in_cell(way.to));
  const int from = common_record(move, part);
  if (from < 0 ? !cross_by_snap(way.base, beside, move)
               : !derive(way.base, nodes_[from], from ^ move.moved, next))
    return false;
  count_switch(way);
  if (from < 0) {
    note_snap();
    return true;
  }
  if (next.is_mixed) {
    std::array<Node, 8> kept;
    for (int k = 0; k < 8; ++k)
      kept[k] = move.keeps(k ^ move.moved) ? nodes_[k ^ move.moved] : BranchNodes::kNoNode;
    // On the common face, edge or vertex, as seen from the new cell.
    Vec3 at = part;
    for (int a = 0; a < 3; ++a)
      if (move.moved >> a & 1) at[a] = move.side >> a & 1 ? 0 : 1;
    find_better(way.base, corner_weights(at), kept, next);
  }
  const std::array<const double*, 8> before = rows_;
  std::array<const double*, 8> after = before;
  enter_branch(next);
  for (int k = 0; k < 8; ++k)
    if (move.keeps(k)) after[k] = rows_[k ^ move.moved];
  if (after != before) keep_state(before, corner_weights(part), after);
  return true;
}

/// Around most records there is one branch: then any common corner will do as the anchor, and what
/// the cells have in common stays.
bool BranchTraversal::cross_on_one_branch(const CellWalk::Part& way, int beside,
                                          const CellSwitch& move) noexcept {
  const Cells& cells = walk_.cells();
  const auto links = grid_.links(nodes_[beside]);
  const int anchor = cells.distinct(beside ^ move.moved);
  std::array<Node, 8> nodes;
  std::array<const double*, 8> rows;
  for (int k = 0; k < 8; ++k) {
    const int before = k ^ move.moved;
    nodes[k] = nodes_[before];
    rows[k] = rows_[before];
    if (move.keeps(before)) continue;
    nodes[k] = cells.destination(links, kBetweenCorners[anchor][cells.distinct(k)], way.base, k);
    if (nodes[k] == BranchNodes::kNoNode) return false;
    rows[k] = grid_.row(nodes[k]).data();
    __builtin_prefetch(rows[k]);
    __builtin_prefetch(rows[k] + row_.size() - 1);
    // What the next switch reads, if the hand goes straight on.
    grid_.fetch_links(nodes[k]);
    grid_.fetch_levels(cells.point(way.base, k) + (way.base - walk_.base()));
  }
  anchor_ = anchor;
  nodes_ = nodes;
  rows_ = rows;
  count_switch(way);
  return true;
}

/// Where the branch does not reach into the new cell: to where the anchor's link leads.
/// @param to the corner of the old cell, common to both, to which it leads
bool BranchTraversal::cross_by_snap(PointIndex base, int to, const CellSwitch& move) noexcept {
  const RecordIndex anchor =
      walk_.cells().destination(nodes_[anchor_], kBetweenCorners[anchor_][to], walk_.base(), to);
  Branch next;
  if (anchor == Grid::kNoRecord || !derive(base, anchor, to ^ move.moved, next)) return false;
  enter_branch(next);
  offset_.end();
  return true;
}

/// The anchor, if the cells have it in common, else the common record that is nearest to the HIP;
/// -1 where they have none in common.
int BranchTraversal::common_record(const CellSwitch& move, const Vec3& part) const noexcept {
  if (move.keeps(anchor_)) return anchor_;
  double nearest = std::numeric_limits<double>::infinity();
  int from = -1;
  for (int k = 0; k < 8; ++k) {
    if (!move.keeps(k) || branches_->is_ghost(nodes_[k]) || distance2(part, k) >= nearest) continue;
    nearest = distance2(part, k);
    from = k;
  }
  return from < 0 ? from : walk_.cells().distinct(from);
}

/// Where corners change without a snap: what the blend loses goes to the offset.
void BranchTraversal::keep_state(const std::array<const double*, 8>& before,
                                 const std::array<double, 8>& weights,
                                 const std::array<const double*, 8>& after) noexcept {
  const std::span<double> offset = offset_.renew();
  for (int k = 0; k < 8; ++k) {
    if (before[k] == after[k] || weights[k] == 0) continue;
    for (std::size_t c = 0; c < offset.size(); ++c)
      offset[c] +=
          weights[k] * (nearest(grid_.spec().equality, c, before[k][c], after[k][c]) - after[k][c]);
  }
}

/// @returns whether the state snapped
bool BranchTraversal::decide_by_grid() noexcept {
  if (is_mixed_) change_anchor();
  int snaps = 0;
  while (snaps < kMostSnaps && is_torn_ && has_ended(nodes_, weights_) && snap(part_)) ++snaps;
  if (snaps > 0) offset_.end();
  return snaps > 0;
}

/// Whether a branch with these corners ends before the place with these weights.
bool BranchTraversal::has_ended(const std::array<Node, 8>& nodes,
                                const std::array<double, 8>& weights) const noexcept {
  double behind = 0;
  for (int k = 0; k < 8; ++k)
    if (branches_->is_ghost(nodes[k])) behind += weights[k];
  return behind > 0.5;
}

/// In a mixed cell the records differ in what the other corners are. Of the records of a branch,
/// the one becomes the anchor whose corners disagree least where the HIP is.
/// @param kept corners that should stay; kNoNode where any will do
/// @returns whether another anchor was found, whose corners disagree less by kBetter at least
bool BranchTraversal::find_better(PointIndex base, const std::array<double, 8>& weights,
                                  const std::array<Node, 8>& kept, Branch& branch) const noexcept {
  const auto cost = [&](const Branch& b) {
    double sum = disagreement(b.apart, weights);
    // To keep corners comes first: a sum of products of weights is small against 8.
    for (int k = 0; k < 8; ++k)
      if (kept[k] != BranchNodes::kNoNode && b.nodes[k] != kept[k]) sum += 8;
    return sum;
  };
  const std::array<Node, 8> candidates = branch.nodes;
  const int present = branch.anchor;
  double least = cost(branch) - kBetter;
  bool found = false;
  for (int k = 0; k < 8 && least > 0; ++k) {
    if (k == present || !walk_.cells().is_corner(k) || branches_->is_ghost(candidates[k])) continue;
    Branch other;
    if (!derive(base, candidates[k], k, other) || !(cost(other) < least)) continue;
    // Ghosts agree with every branch, so one that has ended there would seem the best.
    if (other.is_torn && has_ended(other.nodes, weights)) continue;
    least = cost(other);
    branch = other;
    found = true;
  }
  return found;
}

void BranchTraversal::change_anchor() noexcept {
  if (disagreement(apart_, weights_) <= kBetter) return;
  Branch next{anchor_, nodes_, is_torn_, is_mixed_, apart_};
  constexpr std::array<Node, 8> kAny = [] {
    std::array<Node, 8> any{};
    any.fill(BranchNodes::kNoNode);
    return any;
  }();
  if (!find_better(walk_.base(), weights_, kAny, next)) return;
  const std::array<const double*, 8> before = rows_;
  enter_branch(next);
  keep_state(before, weights_, rows_);
}

/// Goes to where the one-way link leads whose middle is nearest to the HIP. False when there is
/// none.
bool BranchTraversal::snap(const Vec3& part) noexcept {
  double nearest = std::numeric_limits<double>::infinity();
  int to = -1;
  RecordIndex anchor = Grid::kNoRecord;
  for (int k = 0; k < 8; ++k) {
    if (branches_->is_ghost(nodes_[k]) || !walk_.cells().is_corner(k)) continue;
    for (int j = 0; j < 8; ++j) {
      if (!branches_->is_ghost(nodes_[j]) || !walk_.cells().is_corner(j)) continue;
      const int q = kBetweenCorners[k][j];
      if (branches_->node(nodes_[k], q, walk_.cells(), walk_.base(), j) != nodes_[j]) continue;
      double sum = 0;
      for (int a = 0; a < 3; ++a) {
        const double d = part[a] - 0.5 * ((k >> a & 1) + (j >> a & 1));
        sum += d * d;
      }
      if (sum >= nearest) continue;
      nearest = sum;
      to = j;
      anchor = walk_.cells().destination(nodes_[k], q, walk_.base(), j);
    }
  }
  Branch next;
  if (to < 0 || !derive(walk_.base(), anchor, to, next)) return false;
  enter_branch(next);
  return true;
}

void BranchTraversal::evaluate() noexcept {
  blend(weights_, rows_, row_);
  offset_.add_to(row_);
  if (!grid_.spec().equality.has_angles()) return;
  blend_angles(grid_.spec().equality, weights_, rows_, row_);
  orthonormalise_rotations(grid_.spec().equality, row_);
}

}  // namespace hapgrid
