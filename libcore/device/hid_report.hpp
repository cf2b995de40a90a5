// Values in and out of the bytes of a report, where the report descriptor says that they are.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "libcore/device/hid_descriptor.hpp"

namespace hapgrid {

/// The element's value, signed when its logical_min is negative.
/// @param report as hidapi has it, its id first (0 for a device without ids).
/// Nothing for another report's id, a report that is too short, or more than 32 bits.
std::optional<std::int64_t> read_element(std::span<const std::uint8_t> report,
                                         const HidElement& element) noexcept;

/// Writes the value's low bits; all other bits stay. Nothing is held to the logical limits: what is
/// outside of them has a meaning too ("no value"). @return false, and nothing is written, where
/// read_element() would give nothing.
bool write_element(std::span<std::uint8_t> report, const HidElement& element,
                   std::int64_t value) noexcept;

}  // namespace hapgrid
