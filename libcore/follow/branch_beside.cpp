// How a BranchTraversal chooses its branch where the model walks beside the grid.
#include <algorithm>

#include "libcore/follow/beside.hpp"
#include "libcore/follow/branch_traversal.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

// How much nearer to the model's state another branch must be, squared. A branch that is within a
// third of the tolerance stays.
constexpr double kNearer = 0.5;
constexpr double kSame = 1.0 / 3;
// The model has snapped when its state is farther than the tolerance from where play expects it,
// and another branch is nearer by so much, squared.
constexpr double kFarNearer = 0.3;
// How far from the hand the place of an answer may be, in spacings. Beyond it the grid knows
// better.
constexpr double kReach = 0.5;
// How many ticks older than the newest answer another one may be.
constexpr std::uint64_t kOldestKept = 64;

}  // namespace

/// In each step that is usable, when position() is settled.
void BranchTraversal::follow_model() noexcept {
  beside_->receive();
  pass_over_older();
  follow_newest();
  tell_model();
}

/// If the grid has snapped in this tick, late answers still tell of the branch before: they are
/// passed over until one comes that is as late after the snap.
void BranchTraversal::pass_over_older() noexcept {
  const std::uint64_t tick = beside_->tick() + 1;
  const BesideAnswer* const answer = beside_->answer();
  if (step_.started) trusted_from_ = tick;
  if (step_.snapped) trusted_from_ = tick + (answer ? tick - answer->tick : 0);
}

void BranchTraversal::tell_model() noexcept {
  if (step_.started) {
    beside_->start(position());
  } else if (step_.chosen != kNoLevel) {
    beside_->start(position(), step_.chosen);
  } else {
    beside_->follow(position());
  }
}

/// The grid decides where the model does not.
void BranchTraversal::follow_newest() noexcept {
  const BesideAnswer* const newest = beside_->answer();
  follows_as_before_ = false;
  if (!newest || newest->tick < trusted_from_) return follow_grid();
  const BesideAnswer& nearest = keep_nearest(*newest);
  if (length_of(nearest.at - position()) > kReach * grid_.box().spacing) return follow_grid();
  follows_as_before_ = offset_.is_held() && nearest.tick == held_tick_;
  if (follows_as_before_) return;
  followed_ = &nearest;
  held_tick_ = nearest.tick;
  follow(nearest);
}

void BranchTraversal::follow_grid() noexcept {
  followed_ = nullptr;
  offset_.let_go();
  if (!decide_by_grid()) return;
  note_snap();
  pass_over_older();
}

/// A hand that turns round never reaches the place that the newest answer looked ahead to, and an
/// older answer may be nearer to it. @returns the nearest one
const BesideAnswer& BranchTraversal::keep_nearest(const BesideAnswer& newest) noexcept {
  if (kept_[last_kept_].tick != newest.tick) {
    last_kept_ = (last_kept_ + 1) % kKept;
    kept_[last_kept_] = newest;  // as long as those before: nothing is allocated
  }
  const BesideAnswer* nearest = &kept_[last_kept_];
  const auto away = [&](const BesideAnswer& answer) { return length_of(answer.at - position()); };
  for (const BesideAnswer& answer : kept_)
    if (answer.tick >= trusted_from_ && newest.tick - answer.tick <= kOldestKept &&
        away(answer) < away(*nearest))
      nearest = &answer;
  return *nearest;
}

/// Takes the state of the model, as the sum of what the branch of the cell has that is nearest to
/// it, and of what is missing there.
void BranchTraversal::follow(const BesideAnswer& answer) noexcept {
  const std::array<double, 8> weights = corner_weights(walk_.part_beside_cell(answer.at));
  const double tolerance = grid_.spec().tolerance;
  const double present = find_missing(rows_, weights, answer.row, missing_);
  double jump = 0;  // from the interpolated state and the offset, which play expects at this place
  if (offset_.is_held()) {
    std::fill(expected_.begin(), expected_.end(), 0.0);
    offset_.add_to(expected_);
    for (std::size_t c = 0; c < expected_.size(); ++c) expected_[c] -= missing_[c];
    jump = length2(expected_);
  }
  if (present > kSame * kSame * tolerance * tolerance) {
    const std::array<Node, 8> before = nodes_;
    enter_nearest(weights, answer.row, kNearer * present);
    const double left = find_missing(rows_, weights, answer.row, missing_);
    if (nodes_ != before && jump > tolerance * tolerance && left < kFarNearer * jump) {
      note_snap();
      trusted_from_ = answer.tick;  // those before are of the branch before
      offset_.end();
    }
  }
  offset_.hold(missing_, step_.jumped());
}

/// Sets `missing` to what the row of an answer has beyond the interpolation: of all its numbers, or
/// of the first ones, at least those of the state. @returns how far apart both states are, in the
/// unit of the tolerance, squared
double BranchTraversal::find_missing(const std::array<const double*, 8>& rows,
                                     const std::array<double, 8>& weights,
                                     std::span<const double> row,
                                     std::span<double> missing) noexcept {
  const Equality& equality = grid_.spec().equality;
  blend(weights, rows, missing);
  blend_angles(equality, weights, rows, missing);
  for (std::size_t c = 0; c < missing.size(); ++c)
    missing[c] = nearest(equality, c, row[c], missing[c]) - missing[c];
  return length2(missing);
}

/// Of a difference of two states, in the unit of the tolerance, squared.
double BranchTraversal::length2(std::span<const double> difference) const noexcept {
  const std::vector<double>& unit = beside_->weights();
  double sum = 0;
  for (std::size_t c = 0; c < unit.size(); ++c) {
    const double d = unit[c] * difference[c];
    sum += d * d;
  }
  return sum;
}

/// Takes the branch of the cell that is nearest to the state of an answer, if it is nearer than
/// `least`, squared.
void BranchTraversal::enter_nearest(const std::array<double, 8>& weights,
                                    std::span<const double> row, double least) noexcept {
  find_candidates();
  const Branch* found = nullptr;
  for (const Branch& branch : candidates_) {
    std::array<const double*, 8> rows;
    for (int k = 0; k < 8; ++k) rows[k] = branches_->row(branch.nodes[k]);
    const double far =
        find_missing(rows, weights, row, std::span(missing_).first(grid_.state_size()));
    if (far >= least) continue;
    least = far;
    found = &branch;
  }
  if (found) enter_branch(*found);
}

/// Each record in a corner of the cell names a branch.
void BranchTraversal::find_candidates() noexcept {
  if (!candidates_.empty() && candidates_base_ == walk_.base()) return;
  candidates_.clear();
  candidates_base_ = walk_.base();
  for (int k = 0; k < 8; ++k) {
    if (!walk_.cells().is_corner(k)) continue;
    const PointIndex point = walk_.cells().point(walk_.base(), k);
    for (RecordIndex level = 0; level < grid_.levels(point); ++level) {
      Branch branch;
      if (candidates_.size() == kMostCandidates) return;
      if (!derive(walk_.base(), grid_.first(point) + level, k, branch)) continue;
      const bool is_known =
          std::any_of(candidates_.begin(), candidates_.end(),
                      [&](const Branch& other) { return other.nodes == branch.nodes; });
      if (!is_known) candidates_.push_back(branch);
    }
  }
}

}  // namespace hapgrid
