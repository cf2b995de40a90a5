// The 26 directions D of Sect. 2.2 of the paper and the destination levels D_l[d] that are stored
// for them.
#pragma once

#include <array>
#include <cstdint>

namespace hapgrid {

/// The number of a grid point's level: 0 is the state that was found first (Sect. 2.2).
using Level = std::uint8_t;

/// The number of directions, and of destination levels in a record.
inline constexpr int kDirections = 26;

/// Destination level of a direction that leaves the box.
inline constexpr Level kLeavesBox = 255;
/// Destination level of a direction that no merge has settled: the record is in the frontier.
inline constexpr Level kUnsettled = 254;
/// The largest level limit: levels 0 .. kMaxLevels - 1 leave the two marks above free.
inline constexpr int kMaxLevels = 254;

/// A set of directions, bit q for direction q.
using DirectionMask = std::uint32_t;
inline constexpr DirectionMask kAllDirections = (1u << kDirections) - 1;

namespace direction_detail {

constexpr std::array<std::array<int, 3>, kDirections> steps() {
  std::array<std::array<int, 3>, kDirections> steps{};
  for (int q = 0; q < kDirections; ++q) {
    const int cube = q < 13 ? q : q + 1;
    steps[q] = {cube % 3 - 1, cube / 3 % 3 - 1, cube / 9 - 1};
  }
  return steps;
}
inline constexpr auto kSteps = steps();

}  // namespace direction_detail

/// One of the 26 directions, 0 <= q < 26: the cube position (d1+1) + 3 (d2+1) + 9 (d3+1) for
/// d1, d2, d3 in {-1, 0, 1}, ascending, with the centre (position 13) left out.
class Direction {
 public:
  constexpr explicit Direction(int q) : q_(static_cast<std::uint8_t>(q)) {}

  /// The direction with the components `step`, each -1, 0 or 1, not all 0.
  static constexpr Direction of(int d1, int d2, int d3) {
    const int cube = (d1 + 1) + 3 * (d2 + 1) + 9 * (d3 + 1);
    return Direction(cube < 13 ? cube : cube - 1);
  }

  /// The direction up an axis, 0 to 2.
  static constexpr Direction up(int axis) {
    return of(axis == 0 ? 1 : 0, axis == 1 ? 1 : 0, axis == 2 ? 1 : 0);
  }

  constexpr int q() const { return q_; }
  /// The components (d1, d2, d3) in units of the spacing.
  constexpr const std::array<int, 3>& step() const { return direction_detail::kSteps[q_]; }
  /// The direction back.
  constexpr Direction opposite() const { return Direction(kDirections - 1 - q_); }

  friend constexpr bool operator==(Direction, Direction) = default;

 private:
  std::uint8_t q_;
};

}  // namespace hapgrid
