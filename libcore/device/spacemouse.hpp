// 3Dconnexion's SpaceMouse family: a cap on a spring, without force. It reports how far the cap is
// pushed, which sets the speed of the HIP (DeviceInput::rate).
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "libcore/device/hid_protocol.hpp"

namespace hapgrid {

/// Whether these USB ids belong to the family. A wireless receiver may serve another device of the
/// maker as well; the collection to open is usage 01:08, "Multi-axis Controller".
bool is_spacemouse(std::uint16_t vendor, std::uint16_t product);

/// Report 1 carries x, y, z as 16-bit numbers (newer models: and the three rotations), 350 for a
/// full push, some models more; report 2 the rotations of older models, which do not move the HIP;
/// report 3 the buttons, a bit each, and any of them is DeviceInput::reset. Raw axes are x to the
/// right, y towards the user, z down; the rate is in the box's: x to the right, y away from the
/// user, z up.
class SpaceMouseProtocol : public HidProtocol {
 public:
  /// The count of a full push.
  static constexpr double kFull = 350;
  /// Counts up to this one are rest: the cap does not come back to 0 exactly.
  static constexpr double kDeadZone = 8;

  explicit SpaceMouseProtocol(std::string name) : name_(std::move(name)) {}

  DeviceInfo info() const override { return {.name = name_, .unit = DeviceInfo::Unit::kRate}; }
  /// At rest it sends three reports of zeros and is then silent.
  HidTiming timing() const override { return {.stall = 0}; }
  void start(HidChannel&) override {}
  bool decode(std::span<const std::uint8_t> report, DeviceInput& input) noexcept override;
  void encode(const Vec3&, std::vector<HidReport>& reports) noexcept override { reports.clear(); }
  std::vector<HidReport> stop() const override { return {}; }

 private:
  std::string name_;
};

}  // namespace hapgrid
