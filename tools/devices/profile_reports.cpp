#include <algorithm>
#include <cmath>

#include "libcore/grid/vec3.hpp"
#include "tools/devices/profile.hpp"

namespace hapgrid {

namespace {

Vec3 times(const Matrix3& m, const Vec3& v) noexcept {
  Vec3 product{0, 0, 0};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t k = 0; k < 3; ++k) product[row] += m[row][k] * v[k];
  return product;
}

/// Towards the count without force: rounded to the nearest count, three axes could together push
/// harder than the force that the safety core let through.
std::int64_t counts(const Profile::OutputAxis& axis, double newtons) noexcept {
  const double value =
      static_cast<double>(axis.zero) + std::trunc(newtons / axis.newtons_per_count);
  if (!std::isfinite(value)) return axis.zero;
  // Clamped as double, because a large double has no integer.
  return static_cast<std::int64_t>(
      std::clamp(value, static_cast<double>(axis.low), static_cast<double>(axis.high)));
}

/// The force of the outputs' axes, never longer than `force`: rows of force.axes that were written
/// with few digits keep lengths only nearly.
Vec3 on_axes(const Matrix3& axes, const Vec3& force) noexcept {
  if (!finite(force)) return {0, 0, 0};
  Vec3 newtons = times(axes, force);
  const double longer = std::sqrt(dot(newtons, newtons) / dot(force, force));
  if (longer > 1)
    for (double& component : newtons) component /= longer;
  return newtons;
}

/// `bits` bits, beginning with number `bit`.
std::uint64_t get_bits(std::span<const std::uint8_t> data, std::size_t bit,
                       unsigned bits) noexcept {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < bits; ++i)
    value |= std::uint64_t{data[(bit + i) / 8] >> (bit + i) % 8 & 1u} << i;
  return value;
}

/// Writes the value's low bits and leaves all other bits.
void set_bits(std::span<std::uint8_t> data, std::size_t bit, unsigned bits,
              std::uint64_t value) noexcept {
  for (unsigned i = 0; i < bits; ++i) {
    const auto mask = static_cast<std::uint8_t>(1u << (bit + i) % 8);
    std::uint8_t& byte = data[(bit + i) / 8];
    byte = static_cast<std::uint8_t>((value >> i & 1) != 0 ? byte | mask : byte & ~mask);
  }
}

/// The low bits as a number in two's complement.
std::int64_t as_signed(std::uint64_t value, unsigned bits) noexcept {
  const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
  return static_cast<std::int64_t>(value) -
         ((value & sign) != 0 ? static_cast<std::int64_t>(2 * sign) : 0);
}

}  // namespace

std::int64_t BitField::least() const { return is_signed ? -(std::int64_t{1} << (bits - 1)) : 0; }

std::int64_t BitField::most() const {
  return (std::int64_t{1} << (is_signed ? bits - 1 : bits)) - 1;
}

std::int64_t BitField::get(std::span<const std::uint8_t> data) const noexcept {
  std::uint64_t value = 0;
  if (big_endian) {
    for (std::size_t i = 0; i < bits / 8; ++i) value = value << 8 | data[bit / 8 + i];
  } else {
    value = get_bits(data, bit, bits);
  }
  return is_signed ? as_signed(value, bits) : static_cast<std::int64_t>(value);
}

void BitField::set(std::span<std::uint8_t> data, std::int64_t value) const noexcept {
  const auto raw = static_cast<std::uint64_t>(value);  // two's complement
  if (!big_endian) return set_bits(data, bit, bits, raw);
  for (std::size_t i = 0; i < bits / 8; ++i)
    data[bit / 8 + i] = static_cast<std::uint8_t>(raw >> (bits - 8 - 8 * i));
}

bool Profile::decode(std::span<const std::uint8_t> report,
                     hapgrid_device_state& state) const noexcept {
  if (report.size() < 1 + input_length || report[0] != input_id) return false;
  const std::span<const std::uint8_t> data = report.subspan(1);
  Vec3 metres{0, 0, 0};
  for (std::size_t a = 0; a < 3; ++a)
    if (const auto& axis = inputs[a])
      metres[a] = axis->scale * static_cast<double>(axis->field.get(data)) + axis->offset;
  const Vec3 position = times(input_axes, metres);
  std::copy(position.begin(), position.end(), state.position);
  const auto is_pressed = [&](const std::optional<Button>& button) {
    return button && (button->field.get(data) != 0) != button->inverted;
  };
  state.flags = (is_pressed(clutch) ? std::uint32_t{HAPGRID_DEVICE_CLUTCH} : 0) |
                (is_pressed(next) ? std::uint32_t{HAPGRID_DEVICE_NEXT} : 0);
  return true;
}

std::vector<HidReport> Profile::encode(const Vec3& force) const {
  const Vec3 newtons = on_axes(force_axes, force);
  std::vector<HidReport> reports;
  for (const Output& output : outputs) {
    reports.push_back(output.report);
    for (std::size_t a = 0; a < 3; ++a)
      if (const auto& axis = output.axes[a])
        axis->field.set(std::span(reports.back()).subspan(1), counts(*axis, newtons[a]));
  }
  return reports;
}

std::vector<HidReport> Profile::stop_reports() const {
  std::vector<HidReport> reports = encode({0, 0, 0});
  reports.insert(reports.end(), stop.begin(), stop.end());
  return reports;
}

}  // namespace hapgrid
