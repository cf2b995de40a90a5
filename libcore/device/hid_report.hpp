// Values in and out of the bytes of a report, where the report descriptor says that they are.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "libcore/device/hid_descriptor.hpp"

namespace hapgrid {

/// `bits` bits (1 to 32) from `bit` on, the lowest of the first byte being bit 0; all of them are
/// in `data`.
std::uint64_t get_bits(std::span<const std::uint8_t> data, std::size_t bit, unsigned bits) noexcept;
/// Writes the value's low bits; all other bits stay.
void set_bits(std::span<std::uint8_t> data, std::size_t bit, unsigned bits,
              std::uint64_t value) noexcept;
/// The number that these low bits are in two's complement.
std::int64_t as_signed(std::uint64_t value, unsigned bits) noexcept;

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
