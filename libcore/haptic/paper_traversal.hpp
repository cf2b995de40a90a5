// The rule of Algorithm 2 as the paper has it: each corner of a new cell gets the level to which
// the links lead from the corners that the hand comes from.
//
// The state is continuous for every motion of the hand, also where the model snaps: there the
// corners of a cell belong to several branches, and the state is a blend that the model never
// takes. The rule that snaps instead is in branch_traversal.hpp.
#pragma once

#include <array>
#include <cstdint>

#include "libcore/haptic/traversal.hpp"

namespace hapgrid {

class PaperTraversal final : public Traversal {
 public:
  /// As Traversal's.
  explicit PaperTraversal(const Grid& grid, std::uint16_t max_sub_steps = kDefaultMaxSubSteps)
      : Traversal(grid, max_sub_steps) {}

 private:
  /// The corner nearest to the HIP (the lower one of two) gets the level, the other seven its
  /// destination levels. Source: Sect. 2.4. Deviation: level 0 in all corners, as printed, can mix
  /// branches.
  bool begin(int nearest, Level level) noexcept override;
  bool cross(int q, PointIndex base, const Vec3& y, StepResult& result) noexcept override;
  bool move(const Vec3&, StepResult&) noexcept override { return true; }
  void evaluate() noexcept override;
  void set_corners(const Corners& corners) noexcept;

  std::array<const double*, 8> rows_{};
};

}  // namespace hapgrid
