// Tear fractions: how far along a one-way link the model snaps.
#pragma once

#include <cstdint>

namespace hapgrid {

/// The number of the interval, of kTearSteps equal ones along the link, in which the model leaves
/// the branch of the record that the link starts from; kNoTear for any other direction.
using TearByte = std::uint8_t;
inline constexpr TearByte kNoTear = 255;
inline constexpr int kTearSteps = 32;

inline bool is_tear_byte(TearByte tear) { return tear < kTearSteps || tear == kNoTear; }

/// The fraction itself: the middle of the interval, in (0, 1).
inline double tear_fraction(TearByte tear) { return (tear + 0.5) / kTearSteps; }

}  // namespace hapgrid
