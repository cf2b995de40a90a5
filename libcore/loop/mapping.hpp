// Maps the positions of a handle, in metres, to positions of the HIP in the box, and forces in the
// box's axes to forces in the device's axes.
//
// The position of a held device is scaled, turned and shifted; after each use of the clutch the
// shift is another one. A device that steers (DeviceInput::rate) sets the speed of the HIP. The
// positions of a path, a replay and keys are already those of the HIP.
#pragma once

#include <array>

#include "libcore/device/device.hpp"
#include "libcore/grid/box.hpp"

namespace hapgrid {

struct MappingOptions {
  /// Model units per metre of the hand; 0: the device's reach fills the box. For a device with
  /// positions in the box the scale only serves to compute the hand's speed, and 0 means that it is
  /// not known.
  double scale = 0;
  /// Row a names the device's axis that the box's axis a follows, by +1 or -1 in its column.
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  /// Where the middle of the device's reach lies, from the middle of the box, in model's units.
  Vec3 offset{0, 0, 0};
  /// Signs of the force along the device's axes: -1 where the device pushes the wrong way.
  Vec3 push{1, 1, 1};
  /// Speed of a steered HIP at full deflection, in model units a second; 0: the longest side of the
  /// box in four seconds.
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
  /// Turns a force in newtons from the box's axes to the device's.
  Vec3 to_device(const Vec3& force) const noexcept;
  /// Where in the box a place is that the device gives in its own unit. NaN stays NaN.
  Vec3 place(const Vec3& device) const noexcept;
  /// Where a held device puts the HIP there, as long as no clutch was used; needs a scale.
  Vec3 handle(const Vec3& hip) const noexcept;
  /// How far a HIP is outside the box, in grid spacings; 0 inside. Real-time safe.
  double outside_cells(const Vec3& hip) const noexcept;
  /// Model units per metre of the hand; 0: not known.
  double scale() const { return scale_; }

 private:
  Vec3 turned(const Vec3& device) const noexcept;
  Vec3 turned_back(const Vec3& box) const noexcept;

  MappingOptions options_;
  DeviceInfo::Unit unit_;
  double scale_ = 0;
  double speed_ = 0;
  Vec3 low_, high_;  // of the box
  double spacing_;
  Vec3 shift_{0, 0, 0};  // of a held device: hip = scale axes position + shift
  Vec3 steered_{0, 0, 0};
  Vec3 hip_{0, 0, 0};
  bool started_ = false;
  bool clutched_ = false;
};

}  // namespace hapgrid
