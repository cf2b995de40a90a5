// What our adapters have in common: the loop between play's socket and a device, and the command
// line. An adapter is a program of one thread; examples/devices/README.md has the protocol.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "libcore/device/process_protocol.h"
#include "libcore/grid/box.hpp"

namespace hapgrid {

/// A device that is open. The functions do not wait, except for a device that takes no report;
/// play ends an adapter that waits for longer than 0.1 s.
class Hardware {
 public:
  using Clock = std::chrono::steady_clock;

  virtual ~Hardware() = default;
  virtual hapgrid_device_greeting greeting() const = 0;
  /// After so long without a force the device gets zero force.
  virtual Clock::duration patience() const {
    return std::chrono::milliseconds(static_cast<int>(1000 * HAPGRID_DEVICE_SILENCE));
  }

  /// Takes what the device has said since the last call. Only position and flags of `state` are
  /// wanted. @throw DeviceError when the device is lost
  virtual void measure(hapgrid_device_state& state) = 0;
  /// Gives the device a force, in newtons. @throw DeviceError
  virtual void apply(const Vec3& force) = 0;
  /// The model jumps with the next force.
  virtual void snap() {}
  /// When work() wants to be called, for what the device needs beside forces.
  virtual Clock::time_point due() const { return Clock::time_point::max(); }
  virtual void work() {}
  /// Zero force, then whatever leaves the device safe. Each part is tried, also after one failed.
  /// @throw DeviceError for what failed
  virtual void let_go() = 0;
};

/// Whether a signal asks the adapter to end, for a device that takes long to open.
bool is_told_to_end();

/// The words behind the options of an adapter's command line, and --rate.
struct AdapterWords {
  std::vector<std::string> words;
  double rate = 1000;  ///< forces a second that play wants to send
};

/// A line of play --list-devices.
struct ListedDevice {
  std::string device;       ///< for --device
  std::string feels;        ///< "force", "rumble" or "-"
  std::string name;         ///< for people
  std::string forbidden{};  ///< what helps where the user may not open it; empty: nothing to say
};

struct AdapterKind {
  const char* usage;  ///< behind the program's name
  std::function<std::unique_ptr<Hardware>(const AdapterWords&)> open;  ///< @throw Error
  /// Sends zero force to the device, without starting it. @throw Error
  std::function<void(const AdapterWords&)> release;
  std::function<std::vector<ListedDevice>()> list;
};

/// The main() of an adapter. Without options it speaks the protocol; with --release it sends zero
/// force; with --list it writes a line for each device, with tabs between the fields.
int adapter_main(int argc, char** argv, const AdapterKind& kind);

/// A greeting with these properties, and a name that may be longer than its field.
hapgrid_device_greeting made_greeting(const std::string& name, const Vec3& low, const Vec3& high,
                                      double max_force, double rate, std::uint32_t flags);

}  // namespace hapgrid
