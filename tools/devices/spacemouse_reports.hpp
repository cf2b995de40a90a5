// The reports of 3Dconnexion's SpaceMouse family: a cap on a spring, without force. They say how
// far the cap is pushed, which sets the speed of the HIP.
#pragma once

#include <cstdint>
#include <span>

#include "libcore/device/process_protocol.h"

namespace hapgrid {

/// The count of a full push, and counts up to which the cap is at rest: it does not come back to 0
/// exactly.
inline constexpr double kSpaceMouseFull = 350, kSpaceMouseDeadZone = 8;

/// Whether these USB ids belong to the family. A wireless receiver may serve another device of the
/// maker as well; the collection to open is usage 01:08, "Multi-axis Controller".
bool is_spacemouse(std::uint16_t vendor, std::uint16_t product);

/// Report 1 carries x, y, z as 16-bit numbers (newer models: and the three rotations), 350 for a
/// full push, some models more; report 2 the rotations of older models, which do not move the HIP;
/// report 3 the buttons, a bit each, and any of them is HAPGRID_DEVICE_RESET. Raw axes are x to the
/// right, y towards the user, z down; the deflection is in the box's: x to the right, y away from
/// the user, z up.
/// @return whether the report changed `state`
bool decode_spacemouse(std::span<const std::uint8_t> report, hapgrid_device_state& state) noexcept;

}  // namespace hapgrid
