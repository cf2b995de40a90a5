// How a BranchTraversal chooses its branch where the model walks beside the grid.
#include <algorithm>

#include "libcore/grid/vec3.hpp"
#include "libcore/haptic/branch_traversal.hpp"

namespace hapgrid {

namespace {

// How much nearer to the model's state another branch must be, squared: to be taken, and to be
// taken as the result of a snap of the model. A branch that is within a third of the tolerance
// stays.
constexpr double kNearer = 0.5;
constexpr double kFarNearer = 0.3;
constexpr double kSame = 1.0 / 3;
// How far outside the cell a late answer may lie, in spacings.
constexpr double kBeside = 0.5;

}  // namespace

void BranchTraversal::settle(StepResult& result) noexcept {
  if (!beside_) return;
  if (result.started) {
    beside_->start(position());
    doubtful_way_ = 0;
  } else if (result.chosen != kNoLevel) {
    beside_->start(position(), result.chosen);
  } else {
    beside_->follow(position());
  }
  if (is_torn_ || is_mixed_)
    doubtful_way_ = box_.spacing;
  else if (doubtful_way_ > 0)
    doubtful_way_ -= length_of(position() - result.from);
  if (doubtful_way_ <= 0) {
    agreed_ = false;
    return;
  }
  const BesideAnswer* const answer = beside_->answer();
  const std::uint64_t age = answer ? beside_->tick() - answer->tick : 0;
  // The grid decides where the model does not. If the grid has snapped, late answers still tell of
  // the branch before: they are passed over until one comes that is as late after the snap.
  if (result.snapped) trusted_from_ = beside_->tick() + age;
  std::array<double, 8> weights{};
  const bool is_asked =
      answer && answer->tick >= trusted_from_ && find_weights(answer->at, weights);
  if (is_asked)
    enter_nearest(weights, answer->state, result);
  else if (decide_by_grid(result))
    trusted_from_ = beside_->tick() + age;
  agreed_ = is_asked;
}

/// The weights of the corners of this cell at x, which may lie a bit outside; false where it lies
/// far outside.
bool BranchTraversal::find_weights(const Vec3& x, std::array<double, 8>& weights) const noexcept {
  Vec3 part{0, 0, 0};
  for (int a = 0; a < 3; ++a) {
    if (cells_.is_flat(a)) continue;
    part[a] = (x[a] - box_.origin[a]) / box_.spacing - cell()[a];
    if (part[a] < -kBeside || part[a] > 1 + kBeside) return false;
  }
  weights = corner_weights(part);
  return true;
}

/// Takes the branch of the cell that is nearest to a state of the model.
void BranchTraversal::enter_nearest(const std::array<double, 8>& weights,
                                    std::span<const double> state, StepResult& result) noexcept {
  const double same = kSame * grid_.spec().tolerance;
  const double present = difference(nodes_, weights, state);
  if (present <= same * same) return;
  find_candidates();
  double least = kNearer * present;
  const Branch* nearest = nullptr;
  for (const Branch& branch : candidates_) {
    const double far = difference(branch.nodes, weights, state);
    if (far >= least) continue;
    least = far;
    nearest = &branch;
  }
  if (!nearest) return;
  const std::array<const double*, 8> before = rows_;
  if (!result.corners_changed) result.nodes_before = nodes_;
  enter_branch(base(), *nearest);
  result.corners_changed = nodes_ != result.nodes_before;
  if (agreed_ && least < kFarNearer * present) {
    result.snapped = result.level_changed = true;  // the model has snapped since the last answer
    offset_.end();
  } else {
    keep_state(before, weights_, rows_);
  }
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

/// Of an interpolated state and the model's, in the unit of the tolerance, squared.
double BranchTraversal::difference(const std::array<Node, 8>& nodes,
                                   const std::array<double, 8>& weights,
                                   std::span<const double> state) const noexcept {
  std::array<const double*, 8> rows;
  for (int k = 0; k < 8; ++k) rows[k] = map_->nodes.row(nodes[k]);
  const std::vector<double>& unit = beside_->weights();
  double sum = 0;
  for (std::size_t c = 0; c < state.size(); ++c) {
    double d = -state[c];
    for (int k = 0; k < 8; ++k) d += weights[k] * rows[k][c];
    sum += unit[c] * unit[c] * d * d;
  }
  return sum;
}

}  // namespace hapgrid
