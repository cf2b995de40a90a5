#include "libcore/loop/mapping.hpp"

#include <algorithm>
#include <cmath>

#include "libcore/base/error.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

bool is_signed_permutation(const std::array<Vec3, 3>& axes) {
  std::array<int, 3> uses{};
  for (const Vec3& row : axes) {
    int entries = 0;
    for (int b = 0; b < 3; ++b) {
      if (row[b] == 0) continue;
      if (std::abs(row[b]) != 1) return false;
      ++entries;
      ++uses[b];
    }
    if (entries != 1) return false;
  }
  return uses == std::array<int, 3>{1, 1, 1};
}

}  // namespace

Mapping::Mapping(const MappingOptions& options, const DeviceInfo& device, const Box& box)
    : options_(options), unit_(device.unit), spacing_(box.spacing) {
  if (!std::isfinite(options.scale) || options.scale < 0)
    throw Error("mapping: the scale must be finite and not negative");
  if (!std::isfinite(options.speed) || options.speed < 0)
    throw Error("mapping: the speed must be finite and not negative");
  if (!finite(options.offset)) throw Error("mapping: the offset must be finite");
  if (!is_signed_permutation(options.axes))
    throw Error("mapping: the axes must name each of x, y and z once");
  low_ = box.origin;
  high_ = box.high();
  Vec3 middle, side;
  for (int a = 0; a < 3; ++a) {
    middle[a] = (low_[a] + high_[a]) / 2 + options.offset[a];
    side[a] = high_[a] - low_[a];
  }
  scale_ = options.scale;
  const double longest = std::max({side[0], side[1], side[2]});
  speed_ = options.speed > 0 ? options.speed : longest / 4;
  if (unit_ == DeviceInfo::Unit::kMetres) {
    const Vec3 reach = turned({device.high[0] - device.low[0], device.high[1] - device.low[1],
                               device.high[2] - device.low[2]});
    if (scale_ == 0) {
      // Every axis that the device has reaches both faces of the box.
      for (int a = 0; a < 3; ++a)
        if (reach[a] != 0) scale_ = std::max(scale_, side[a] / std::abs(reach[a]));
      if (!(scale_ > 0) || !std::isfinite(scale_))
        throw Error("mapping: the device does not say how far it reaches: give a scale");
    }
    const Vec3 centre =
        turned({(device.low[0] + device.high[0]) / 2, (device.low[1] + device.high[1]) / 2,
                (device.low[2] + device.high[2]) / 2});
    for (int a = 0; a < 3; ++a) shift_[a] = middle[a] - scale_ * centre[a];
  }
  for (int a = 0; a < 3; ++a) steered_[a] = std::clamp(middle[a], low_[a], high_[a]);
}

Vec3 Mapping::turned(const Vec3& device) const noexcept {
  Vec3 out{0, 0, 0};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      if (options_.axes[a][b] != 0) out[a] = options_.axes[a][b] * device[b];
  return out;
}

Vec3 Mapping::hip(const DeviceInput& input, double dt) noexcept {
  switch (unit_) {
    case DeviceInfo::Unit::kModel:
      break;
    case DeviceInfo::Unit::kRate: {
      const Vec3 way = turned(input.rate);
      for (int a = 0; a < 3; ++a)
        steered_[a] = std::clamp(steered_[a] + way[a] * speed_ * dt, low_[a], high_[a]);
      return steered_;
    }
    case DeviceInfo::Unit::kMetres: {
      const Vec3 hand = turned(input.position);
      if (input.clutch && started_) {
        clutched_ = true;
        return hip_;
      }
      for (int a = 0; a < 3; ++a) {
        if (clutched_) shift_[a] = hip_[a] - scale_ * hand[a];
        hip_[a] = scale_ * hand[a] + shift_[a];
      }
      clutched_ = false;
      started_ = true;
      return hip_;
    }
  }
  return input.position;
}

Vec3 Mapping::place(const Vec3& device) const noexcept {
  if (unit_ == DeviceInfo::Unit::kModel) return device;
  return scale_ * turned(device) + shift_;
}

Vec3 Mapping::turned_back(const Vec3& box) const noexcept {
  Vec3 out{0, 0, 0};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      if (options_.axes[a][b] != 0) out[b] = options_.axes[a][b] * box[a];
  return out;
}

Vec3 Mapping::to_device(const Vec3& force) const noexcept {
  if (unit_ == DeviceInfo::Unit::kModel) return force;
  Vec3 out = turned_back(force);
  for (int a = 0; a < 3; ++a) out[a] *= options_.push[a];
  return out;
}

Vec3 Mapping::handle(const Vec3& hip) const noexcept {
  Vec3 hand;
  for (int a = 0; a < 3; ++a) hand[a] = (hip[a] - shift_[a]) / scale_;
  return unit_ == DeviceInfo::Unit::kModel ? hand : turned_back(hand);
}

double Mapping::outside_cells(const Vec3& hip) const noexcept {
  Vec3 beyond{0, 0, 0};
  for (int a = 0; a < 3; ++a)
    beyond[a] = std::max({0.0, low_[a] - hip[a], hip[a] - high_[a]}) / spacing_;
  return length_of(beyond);  // std::hypot rounds otherwise in a browser
}

}  // namespace hapgrid
