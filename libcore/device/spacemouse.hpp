// 3Dconnexion's SpaceMouse family: a cap on a spring, without force. What it says is how far it is
// pushed, so it steers how fast the HIP moves (DeviceInput::rate).
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "libcore/device/hid_protocol.hpp"

namespace hapgrid {

/// Whether these USB ids belong to one of the family. A wireless receiver may carry another of the
/// maker's devices: the collection to open is usage 01:08, "Multi-axis Controller".
bool is_spacemouse(std::uint16_t vendor, std::uint16_t product);

/// Report 1 carries x, y, z as 16-bit numbers (newer models: and the three rotations), 350 for a
/// full push, some models more; report 2 the rotations of older models, which do not move the HIP;
/// report 3 the buttons, a bit each, and any of them is DeviceInput::reset. Raw axes are x to the
/// right, y towards the user, z down; the rate is in the box's: x to the right, y away from the
/// user, z up.
class SpaceMouseProtocol : public HidProtocol {
 public:
  /// Counts of a full push.
  static constexpr double kFull = 350;
  /// Counts that are rest: the cap does not come back to 0 exactly.
  static constexpr double kDeadZone = 8;

  explicit SpaceMouseProtocol(std::string name) : name_(std::move(name)) {}

  DeviceInfo info() const override { return {.name = name_, .unit = DeviceInfo::Unit::kRate}; }
  /// Three reports of zeros, and then silence, are its rest.
  HidTiming timing() const override { return {.stall = 0}; }
  void start(HidChannel&) override {}
  bool decode(std::span<const std::uint8_t> report, DeviceInput& input) noexcept override;
  void encode(const Vec3&, std::vector<HidReport>& reports) noexcept override { reports.clear(); }
  std::vector<HidReport> stop() const override { return {}; }

 private:
  std::string name_;
};

}  // namespace hapgrid
