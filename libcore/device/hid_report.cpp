#include "libcore/device/hid_report.hpp"

namespace hapgrid {

namespace {

bool covers(std::span<const std::uint8_t> report, const HidElement& element) noexcept {
  return !report.empty() && report[0] == element.report_id && element.bit_size >= 1 &&
         element.bit_size <= 32 &&
         std::uint64_t{element.bit_offset} + element.bit_size <= 8 * (report.size() - 1);
}

}  // namespace

std::uint64_t get_bits(std::span<const std::uint8_t> data, std::size_t bit,
                       unsigned bits) noexcept {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < bits; ++i)
    value |= std::uint64_t{data[(bit + i) / 8] >> (bit + i) % 8 & 1u} << i;
  return value;
}

void set_bits(std::span<std::uint8_t> data, std::size_t bit, unsigned bits,
              std::uint64_t value) noexcept {
  for (unsigned i = 0; i < bits; ++i) {
    const auto mask = static_cast<std::uint8_t>(1u << (bit + i) % 8);
    std::uint8_t& byte = data[(bit + i) / 8];
    byte = static_cast<std::uint8_t>((value >> i & 1) != 0 ? byte | mask : byte & ~mask);
  }
}

std::int64_t as_signed(std::uint64_t value, unsigned bits) noexcept {
  const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
  return static_cast<std::int64_t>(value) -
         ((value & sign) != 0 ? static_cast<std::int64_t>(2 * sign) : 0);
}

std::optional<std::int64_t> read_element(std::span<const std::uint8_t> report,
                                         const HidElement& element) noexcept {
  if (!covers(report, element)) return std::nullopt;
  const std::uint64_t value = get_bits(report.subspan(1), element.bit_offset, element.bit_size);
  return element.logical_min < 0 ? as_signed(value, element.bit_size)
                                 : static_cast<std::int64_t>(value);
}

bool write_element(std::span<std::uint8_t> report, const HidElement& element,
                   std::int64_t value) noexcept {
  if (!covers(report, element)) return false;
  set_bits(report.subspan(1), element.bit_offset, element.bit_size,
           static_cast<std::uint64_t>(value));
  return true;
}

}  // namespace hapgrid
