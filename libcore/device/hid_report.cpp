#include "libcore/device/hid_report.hpp"

namespace hapgrid {

namespace {

bool covers(std::span<const std::uint8_t> report, const HidElement& element) noexcept {
  return !report.empty() && report[0] == element.report_id && element.bit_size >= 1 &&
         element.bit_size <= 32 &&
         std::uint64_t{element.bit_offset} + element.bit_size <= 8 * (report.size() - 1);
}

}  // namespace

std::optional<std::int64_t> read_element(std::span<const std::uint8_t> report,
                                         const HidElement& element) noexcept {
  if (!covers(report, element)) return std::nullopt;
  std::uint64_t value = 0;
  for (std::uint32_t i = 0; i < element.bit_size; ++i) {
    const std::uint32_t bit = element.bit_offset + i;
    value |= std::uint64_t{report[1 + bit / 8] >> (bit % 8) & 1U} << i;
  }
  const std::uint64_t sign = std::uint64_t{1} << (element.bit_size - 1);
  if (element.logical_min < 0 && (value & sign) != 0) {
    return static_cast<std::int64_t>(value) - static_cast<std::int64_t>(2 * sign);
  }
  return static_cast<std::int64_t>(value);
}

bool write_element(std::span<std::uint8_t> report, const HidElement& element,
                   std::int64_t value) noexcept {
  if (!covers(report, element)) return false;
  for (std::uint32_t i = 0; i < element.bit_size; ++i) {
    const std::uint32_t bit = element.bit_offset + i;
    const auto mask = static_cast<std::uint8_t>(1U << (bit % 8));
    std::uint8_t& byte = report[1 + bit / 8];
    byte = static_cast<std::uint8_t>((value >> i & 1) != 0 ? byte | mask : byte & ~mask);
  }
  return true;
}

}  // namespace hapgrid
