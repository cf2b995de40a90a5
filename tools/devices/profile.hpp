// A HID device described by a text: where in its reports its axes are, what they mean in metres and
// newtons, and what it has to be told. The keys, their units and defaults: examples/devices.
//
// Devices with three axes and an open protocol are nearly all somebody's own, with a format of
// their own. Alternatives: code for each (nobody's device is there), axes found by their usages in
// the report descriptor (says nothing of units and signs, and firmware on a Teensy has no usages).
// So the text says where bits are.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libcore/device/process_protocol.h"
#include "libcore/grid/box.hpp"
#include "tools/devices/hid_bus.hpp"
#include "tools/devices/hid_handle.hpp"

namespace hapgrid {

/// Bits of a report, counted after its id as in report descriptors: bit 0 is the lowest of the
/// first byte.
struct BitField {
  std::size_t bit = 0;
  unsigned bits = 1;  ///< 1 to 32
  bool is_signed = true;
  bool big_endian = false;  ///< only for whole bytes

  std::int64_t least() const;
  std::int64_t most() const;
  /// `data` is a report without its id, and long enough.
  std::int64_t get(std::span<const std::uint8_t> data) const noexcept;
  void set(std::span<std::uint8_t> data, std::int64_t value) const noexcept;
};

/// Times in seconds.
struct ProfileTiming {
  double stall = 0.1;      ///< after this silence the position is old
  double watchdog = 0.05;  ///< the device gets zero force after this time without a force
  /// How often the keep-alive reports are written, or, without any, the force again; 0: never.
  double keep_alive = 0;
};

using Matrix3 = std::array<Vec3, 3>;  // rows

struct Profile {
  struct InputAxis {
    BitField field;
    double scale = 0;   ///< metres a count
    double offset = 0;  ///< metres at count 0
  };
  struct Button {
    BitField field;  ///< one bit
    bool inverted = false;
  };
  struct OutputAxis {
    BitField field;
    double newtons_per_count = 0;
    std::int64_t zero = 0;           ///< the count without force
    std::int64_t low = 0, high = 0;  ///< limits of the count
  };
  struct Output {
    HidReport report;  ///< id first, with the fixed bytes
    std::array<std::optional<OutputAxis>, 3> axes;
  };
  struct Literal {
    bool is_feature = false;
    HidReport report;  ///< id first
  };

  std::string file;  ///< for messages
  std::string name;
  HidMatch match;  ///< vid and pid at least
  std::uint8_t input_id = 0;
  std::size_t input_length = 0;  ///< bytes after the id
  std::array<std::optional<InputAxis>, 3> inputs;
  std::optional<Button> clutch, next;
  Matrix3 input_axes{};  ///< position = input_axes * what the axes say
  std::vector<Output> outputs;
  double max_force = 0;  ///< newtons that the device can hold for long; 0: no force
  Matrix3 force_axes{};  ///< forces of the output axes = force_axes * force
  std::vector<Literal> init;
  std::vector<HidReport> keep_alive, stop;
  ProfileTiming timing;
  Vec3 low{}, high{};  ///< metres

  /// Reads an input report, its id first (0 for a device without ids), into position and buttons.
  /// @return false, and `state` is unchanged, for a report that has another id or is too short
  bool decode(std::span<const std::uint8_t> report, hapgrid_device_state& state) const noexcept;
  /// Makes the output reports for a force, in newtons, in their order. Forces are rounded towards
  /// zero, so that the device never gets a larger force than the one sent. A value beyond the
  /// limits of a field becomes the limit. A force that is not finite counts as zero.
  std::vector<HidReport> encode(const Vec3& force) const;
  /// Zero force, then the stop reports: what leaves the device without force, whatever state it is
  /// in.
  std::vector<HidReport> stop_reports() const;
};

/// @param name for messages.
/// @throw Error "NAME: line N: KEY: ..." for a key that is missing, unknown or out of its range.
Profile read_profile(const std::string& text, const std::string& name);

}  // namespace hapgrid
