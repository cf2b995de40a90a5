// What one kind of HID device says and understands: the reports, and nothing of threads or handles
// (HidDevice has those). A text profile, the PID class, and a SpaceMouse are the three kinds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/device/device.hpp"

namespace hapgrid {

/// A report as hidapi writes it: the id first, 0 for a device without ids.
using HidReport = std::vector<std::uint8_t>;

/// An open device as a protocol sees it while it is being started: synchronous, may take long.
class HidChannel {
 public:
  virtual ~HidChannel() = default;
  /// An output report. @throw DeviceError when the device did not take all of it.
  virtual void write(std::span<const std::uint8_t> report) = 0;
  /// A feature report to the device. @throw DeviceError
  virtual void set_feature(std::span<const std::uint8_t> report) = 0;
  /// The feature report `id`, at most `size` bytes with the id. @throw DeviceError
  virtual HidReport get_feature(std::uint8_t id, std::size_t size) = 0;
};

/// How patient to be with a device; seconds.
struct HidTiming {
  double stall = 0.1;      ///< silent for longer is DeviceInput::stalled; 0: silence is its rest
  double watchdog = 0.05;  ///< no send() for longer: HidDevice writes zero force; 0: never
  /// How often keep_alive() is written or, where it is empty, the force repeated when nothing new
  /// came; 0: never.
  double keep_alive = 0;
};

/// decode() and encode() are called from two threads at the same time: neither may write anything
/// in the object that the other one uses.
class HidProtocol {
 public:
  virtual ~HidProtocol() = default;

  virtual DeviceInfo info() const = 0;
  virtual HidTiming timing() const = 0;
  /// Whether the device's input reports begin with an id. hidapi does not say, and hands out those
  /// of a device without ids without the 0 that it wants to see in what is written.
  virtual bool numbered() const { return true; }

  /// Once, before any report is read or written: takes the device into use, without force.
  /// @throw DeviceError, one line that says what the device did not do.
  virtual void start(HidChannel& channel) = 0;
  /// Takes an input report apart, its id first (0 for a device without ids); false for one that
  /// says nothing of the input, is too short, or has the wrong id: `input` is unchanged then.
  virtual bool decode(std::span<const std::uint8_t> report, DeviceInput& input) noexcept = 0;
  /// The output reports for a force (newtons, in the device's axes), in the order in which they go
  /// out. `reports` is what the last call left: storage to write into. No allocation after the
  /// first call.
  virtual void encode(const Vec3& force, std::vector<HidReport>& reports) noexcept = 0;
  /// The output reports of a device that wants to hear something beside the force; see HidTiming.
  virtual std::vector<HidReport> keep_alive() const { return {}; }
  /// The output reports that leave the device without force, whatever state it is in, also before
  /// start(): the last thing that is written, by HidDevice and by whoever watches over it from
  /// another process (HidGuard).
  virtual std::vector<HidReport> stop() const = 0;
};

}  // namespace hapgrid
