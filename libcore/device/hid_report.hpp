// Reads and writes values in the bytes of a report, at the place that the report descriptor gives.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "libcore/device/hid_descriptor.hpp"

namespace hapgrid {

/// `bits` bits (1 to 32), beginning with number `bit`; bit 0 is the lowest of the first byte. All
/// of them must lie in `data`.
std::uint64_t get_bits(std::span<const std::uint8_t> data, std::size_t bit, unsigned bits) noexcept;
/// Writes the value's low bits and leaves all other bits.
void set_bits(std::span<std::uint8_t> data, std::size_t bit, unsigned bits,
              std::uint64_t value) noexcept;
/// The low bits as a number in two's complement.
std::int64_t as_signed(std::uint64_t value, unsigned bits) noexcept;

/// The element's value, signed when its logical_min is negative. Nothing when the report has
/// another id or is too short, or the element has more than 32 bits.
/// @param report as hidapi has it, its id first (0 for a device without ids).
std::optional<std::int64_t> read_element(std::span<const std::uint8_t> report,
                                         const HidElement& element) noexcept;

/// Writes the value's low bits and leaves all other bits. Does not check the logical limits,
/// because a value outside has a meaning, too ("no value"). @return false, without writing, when
/// read_element() would give nothing
bool write_element(std::span<std::uint8_t> report, const HidElement& element,
                   std::int64_t value) noexcept;

}  // namespace hapgrid
