// Where each branch of a grid ends: a function of place for each branch, which is positive where
// the branch is, and negative beyond the place where the model snaps off it.
//
// It is given at the nodes of the sheets (sheets.hpp) and interpolated in a cell like everything
// else. A tear fraction says where it has to be 0: one equation for each one-way link, in the
// numbers of the corners of the cell that the link crosses. The start is the distance from the
// plane that fits the tear fractions around a node best; then the equations of all links are solved
// together, in the sense of least squares.
#pragma once

#include <span>
#include <vector>

#include "libcore/base/ranked_bits.hpp"
#include "libcore/haptic/sheets.hpp"

namespace hapgrid {

/// In spacings, positive at records and negative at ghosts; 2 at records around which nothing
/// tears, which have no entry. A grid without tear fractions tears in the middle of its one-way
/// links.
class TearFunction {
 public:
  TearFunction(const Grid& grid, const Sheets& sheets);

  /// Real-time safe.
  float operator[](Node node) const noexcept {
    return is_near_.has(node) ? values_[is_near_.rank(node)] : kNothingTears;
  }

 private:
  static constexpr float kNothingTears = 2;
  RankedBits is_near_;
  std::vector<float> values_;
};

/// Where on the one-way link in direction q of record r the model snaps, in (0, 1).
inline double tear_fraction(const Grid& grid, RecordIndex r, int q) {
  const TearByte tear = grid.has_tears() ? grid.tears(r)[q] : kNoTear;
  return tear == kNoTear ? 0.5 : tear_fraction(tear);
}

}  // namespace hapgrid
