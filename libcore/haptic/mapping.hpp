// Where a handle of so many centimetres moves a HIP in a box of so many angstrom, and back: forces
// in the box's axes to the device's.
//
// A device that is held is scaled, turned, and shifted (and, with the clutch held, shifted anew);
// one that is steered (DeviceInput::rate) moves the HIP with a speed; one that speaks of the box
// itself (a path, a replay, keys) is taken at its word.
#pragma once

#include <array>

#include "libcore/device/device.hpp"
#include "libcore/grid/box.hpp"

namespace hapgrid {

struct MappingOptions {
  /// Model's units of length for a metre of the hand; 0: as large as the device's reach fills the
  /// box. For a device that speaks of the box it is only what a speed in m/s is computed with, and
  /// 0 means that it is not known.
  double scale = 0;
  /// Row a: which of the device's axes the box's axis a follows; +1 or -1 in one column each.
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  /// Where the middle of the device's reach lies, from the middle of the box, in model's units.
  Vec3 offset{0, 0, 0};
  /// Of a HIP that is steered, at full deflection: model's units a second; 0: the box's longest
  /// side in four seconds.
  double speed = 0;
};

/// For one thread; real-time safe after construction.
class Mapping {
 public:
  /// @throw Error when a number is not finite, the scale or speed is negative, or axes is no
  /// permutation with signs; when the scale is 0 and the device has no reach that could fill a box.
  Mapping(const MappingOptions& options, const DeviceInfo& device, const Box& box);

  /// The HIP in the model's unit of length. @param dt seconds since the call before.
  Vec3 hip(const DeviceInput& input, double dt) noexcept;
  /// A force in the box's axes, in those of the device; newtons both.
  Vec3 to_device(const Vec3& force) const noexcept;
  /// How far a HIP is outside the box, in grid spacings; 0 inside. Real-time safe.
  double outside_cells(const Vec3& hip) const noexcept;
  /// Model's units of length for a metre of the hand; 0: not known.
  double scale() const { return scale_; }

 private:
  Vec3 turned(const Vec3& device) const noexcept;

  MappingOptions options_;
  DeviceInfo::Unit unit_;
  double scale_ = 0;
  double speed_ = 0;
  Vec3 low_, high_;  // of the box
  double spacing_;
  Vec3 shift_{0, 0, 0};  // of a held one: hip = scale axes position + shift
  Vec3 steered_{0, 0, 0};
  Vec3 hip_{0, 0, 0};
  bool started_ = false;
  bool clutched_ = false;
};

}  // namespace hapgrid
