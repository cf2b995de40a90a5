// How a BranchTraversal chooses its branch where the model walks beside the grid.
#include <algorithm>
#include <utility>

#include "libcore/grid/vec3.hpp"
#include "libcore/haptic/branch_traversal.hpp"

namespace hapgrid {

namespace {

// How much nearer to the model's state another branch must be, squared. A branch that is within a
// third of the tolerance stays.
constexpr double kNearer = 0.5;
constexpr double kSame = 1.0 / 3;
// The model has snapped when its state is farther than the tolerance from where play expects it,
// and another branch is nearer by so much, squared.
constexpr double kFarNearer = 0.3;
// How far outside the cell a late answer may lie, in spacings.
constexpr double kBeside = 0.5;
// How many ticks older than the newest answer another one may be.
constexpr std::uint64_t kOldestKept = 64;

bool is_near_cell(const Vec3& part) {
  return std::all_of(part.begin(), part.end(),
                     [](double u) { return u >= -kBeside && u <= 1 + kBeside; });
}

}  // namespace

void BranchTraversal::settle(StepResult& result) noexcept {
  if (!beside_) return;
  if (beside_->has_thread()) {
    pass_over_older(result, beside_->tick() + 1);
    next_place_ = result.started ? position() : position() + (position() - result.from);
    result.still_held = offset_.is_held();
    if (!result.still_held) followed_ = nullptr;
    is_told_ = false;
    return;
  }
  tell(result);
  pass_over_older(result, beside_->tick());
  next_place_ = position();
  follow_newest(result);
}

/// If the grid has snapped in this tick, late answers still tell of the branch before: they are
/// passed over until one comes that is as late after the snap.
void BranchTraversal::pass_over_older(const StepResult& result, std::uint64_t tick) noexcept {
  if (result.started) trusted_from_ = tick;
  if (result.snapped) trusted_from_ = tick + age_of_answer(tick);
}

void BranchTraversal::tell_model() noexcept {
  if (!std::exchange(is_told_, true)) tell(last_step());
}

void BranchTraversal::tell(const StepResult& result) noexcept {
  if (result.started) {
    beside_->start(position());
  } else if (result.chosen != kNoLevel) {
    beside_->start(position(), result.chosen);
  } else {
    beside_->follow(position());
  }
}

void BranchTraversal::follow_model(StepResult& result) noexcept {
  beside_->receive();
  follow_newest(result);
}

/// The newest answer's in this tick, in ticks; 0 where there is none.
std::uint64_t BranchTraversal::age_of_answer(std::uint64_t tick) const noexcept {
  const BesideAnswer* const answer = beside_->answer();
  return answer ? tick - answer->tick : 0;
}

/// The grid decides where the model does not.
void BranchTraversal::follow_newest(StepResult& result) noexcept {
  const BesideAnswer* const answer = beside_->answer();
  if (answer && answer->tick >= trusted_from_ && is_near_cell(part_beside_cell(answer->at))) {
    const BesideAnswer& nearest = keep_nearest(*answer);
    result.still_held = offset_.is_held() && nearest.tick == held_tick_;
    if (result.still_held) return;
    followed_ = &nearest;
    held_tick_ = nearest.tick;
    follow(nearest, result);
    return;
  }
  followed_ = nullptr;
  offset_.let_go();
  if (decide_by_grid(result)) pass_over_older(result, beside_->tick());
}

/// A hand that turns round does not come to where the model looked ahead, but back to where it was:
/// one of the last answers may be nearer to it than the newest. @returns the nearest one
const BesideAnswer& BranchTraversal::keep_nearest(const BesideAnswer& newest) noexcept {
  if (kept_[last_kept_].tick != newest.tick) {
    last_kept_ = (last_kept_ + 1) % kKept;
    kept_[last_kept_] = newest;  // as long as those before: nothing is allocated
  }
  const BesideAnswer* nearest = &kept_[last_kept_];
  const auto away = [&](const BesideAnswer& answer) { return length_of(answer.at - next_place_); };
  for (const BesideAnswer& answer : kept_)
    if (answer.tick >= trusted_from_ && newest.tick - answer.tick <= kOldestKept &&
        away(answer) < away(*nearest))
      nearest = &answer;
  return *nearest;
}

/// Takes the state of the model, as the sum of what the branch of the cell has that is nearest to
/// it, and of what is missing there.
void BranchTraversal::follow(const BesideAnswer& answer, StepResult& result) noexcept {
  const std::array<double, 8> weights = corner_weights(part_beside_cell(answer.at));
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
    enter_nearest(weights, answer.row, kNearer * present, result);
    const double left = find_missing(rows_, weights, answer.row, missing_);
    if (nodes_ != before && jump > tolerance * tolerance && left < kFarNearer * jump) {
      result.snapped = result.level_changed = true;
      trusted_from_ = answer.tick;  // those before are of the branch before
      offset_.end();
    }
  }
  offset_.hold(missing_, result.jumped());
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
                                    std::span<const double> row, double least,
                                    StepResult& result) noexcept {
  find_candidates();
  const Branch* found = nullptr;
  for (const Branch& branch : candidates_) {
    std::array<const double*, 8> rows;
    for (int k = 0; k < 8; ++k) rows[k] = map_->nodes.row(branch.nodes[k]);
    const double far =
        find_missing(rows, weights, row, std::span(missing_).first(grid_.state_size()));
    if (far >= least) continue;
    least = far;
    found = &branch;
  }
  if (!found) return;
  if (!result.corners_changed) result.nodes_before = nodes_;
  enter_branch(base(), *found);
  result.corners_changed = nodes_ != result.nodes_before;
}

/// Each record in a corner of the cell names a branch.
void BranchTraversal::find_candidates() noexcept {
  if (!candidates_.empty() && candidates_base_ == base()) return;
  candidates_.clear();
  candidates_base_ = base();
  for (int k = 0; k < 8; ++k) {
    if (!cells_.is_corner(k)) continue;
    const PointIndex point = cells_.point(base(), k);
    for (RecordIndex level = 0; level < grid_.levels(point); ++level) {
      Branch branch;
      if (candidates_.size() == kMostCandidates) return;
      if (!derive(base(), grid_.first(point) + level, k, branch)) continue;
      const bool is_known =
          std::any_of(candidates_.begin(), candidates_.end(),
                      [&](const Branch& other) { return other.nodes == branch.nodes; });
      if (!is_known) candidates_.push_back(branch);
    }
  }
}

}  // namespace hapgrid
