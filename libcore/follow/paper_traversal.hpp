// The rule of Algorithm 2 as the paper has it: each corner of a new cell gets the level to which
// the links lead from the corners that the hand comes from.
//
// The state is continuous for every motion of the hand, also where the model snaps: there the
// corners of a cell belong to several branches, and the state is a blend that the model never
// takes. The rule that snaps instead is in branch_traversal.hpp.
#pragma once

#include <array>
#include <cstdint>

#include "libcore/follow/traversal.hpp"

namespace hapgrid {

class PaperTraversal final : public Traversal {
 public:
  /// As CellWalk's.
  explicit PaperTraversal(const Grid& grid, std::uint16_t most_parts = CellWalk::kDefaultMaxParts)
      : Traversal(grid, most_parts) {}
  using Traversal::start;
  using Traversal::step;
  const StepResult& start(const Vec3& hip, Level level) noexcept override;
  const StepResult& step(const Vec3& hip, bool next) noexcept override;

 private:
  bool take(int nearest, Level level) noexcept;
  bool cross(const CellWalk::Part& part) noexcept;
  bool set_corners(PointIndex base, const std::array<RecordIndex, 8>& records) noexcept;
  void evaluate() noexcept;

  std::array<const double*, 8> rows_{};
  std::array<Level, 8> levels_{};
};

}  // namespace hapgrid
