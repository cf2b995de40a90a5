// The reports of one kind of device; HidDevice has the threads and handles. There are three kinds:
// a text profile, a SpaceMouse, and the kernel's event devices (evdev), whose events and effects
// are passed as reports, too.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/device/device.hpp"

namespace hapgrid {

/// A report as hidapi writes it: the id first, 0 for a device without ids.
using HidReport = std::vector<std::uint8_t>;

/// An open device while it is being started. Calls wait for the device and may take long.
class HidChannel {
 public:
  virtual ~HidChannel() = default;
  /// An output report. @throw DeviceError when the device did not take all of it.
  virtual void write(std::span<const std::uint8_t> report) = 0;
  /// A feature report to the device. @throw DeviceError
  virtual void set_feature(std::span<const std::uint8_t> report) = 0;
};

/// An open device; for one thread at a time.
class HidWire : public HidChannel {
 public:
  HidWire() = default;
  HidWire(const HidWire&) = delete;
  HidWire& operator=(const HidWire&) = delete;

  /// Waits at most `milliseconds` for an input report.
  /// @return its size; 0 when none came; -1 when the device is lost
  virtual int read(std::span<std::uint8_t> buffer, int milliseconds) noexcept = 0;
  /// Writes an output report, and may wait for the device. @return whether it took all of it
  virtual bool try_write(std::span<const std::uint8_t> report) noexcept = 0;
  /// Why the last call failed, in one line.
  virtual std::string error() const = 0;
};

/// Times in seconds.
struct HidTiming {
  double stall = 0.1;      ///< after this silence DeviceInput::stalled; 0: it is silent at rest
  double watchdog = 0.05;  ///< HidDevice writes zero force after this time without send(); 0: never
  /// How often keep_alive() is written, or, when that is empty, a force that did not change; 0:
  /// never.
  double keep_alive = 0;
  /// The writer rests so long after each force, where nobody else keeps it from writing more than
  /// the device can take.
  double rest = 0;
  bool greets = false;  ///< it says where it is when it is opened, however silent it is later
};

/// Two threads call decode() and encode() at the same time: neither may write what the other uses.
class HidProtocol {
 public:
  virtual ~HidProtocol() = default;

  virtual DeviceInfo info() const = 0;
  virtual HidTiming timing() const = 0;
  /// Whether the device's input reports begin with an id. hidapi does not tell: it reads reports of
  /// a device without ids as they are, but wants a 0 before those that it writes.
  virtual bool numbered() const { return true; }

  /// Starts the device, without force. Called once, before any report is read or written.
  /// @throw DeviceError, which says in one line what the device did not do
  virtual void start(HidChannel& channel) = 0;
  /// Reads an input report, its id first (0 for a device without ids). @return false, and `input`
  /// is unchanged, for a report that has another id, is too short, or has no input
  virtual bool decode(std::span<const std::uint8_t> report, DeviceInput& input) noexcept = 0;
  /// Makes the output reports for a force (newtons, in the device's axes), in their order.
  /// `reports` holds those of the last call, so that only the first call allocates.
  virtual void encode(const Vec3& force, std::vector<HidReport>& reports) noexcept = 0;
  /// The output reports that tell the device that this program is alive; see HidTiming.
  virtual std::vector<HidReport> keep_alive() const { return {}; }
  /// The output reports that let the hand feel a snap (Device::snap()).
  virtual std::vector<HidReport> snap() const { return {}; }
  /// The output reports that leave the device without force, whatever state it is in, also before
  /// start(). HidDevice and HidGuard write them last.
  virtual std::vector<HidReport> stop() const = 0;
};

}  // namespace hapgrid
