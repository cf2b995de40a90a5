// A device that is a process: an adapter drives it, beside this program, and speaks the protocol of
// process_protocol.h. All hardware is reached in this way.
//
// Problem. Most devices with three axes are driven by a closed library of their maker, which must
// not run in this program, and any driver can make the loop wait. Choice: each tick sends one
// force, and the next tick reads the one state that answers it. The answer has had a whole period
// to come, so that reading it does not wait. A late adapter makes the tick late, and the loop
// counts it as missed. The position that a tick reads was measured after the force of the tick
// before; the energy tank allows for that tick (TankTerms::delay). There are no queues, and no
// threads. Alternatives: an adapter that sends at its own rate (positions are fresher, but it must
// not block when this program stands still, and each adapter would have to get that right); to send
// and wait in the same tick (fresher by a period, and the loop waits for hardware in every tick).
//
// | what                                         | outcome                                   |
// |----------------------------------------------|-------------------------------------------|
// | no answer for HAPGRID_DEVICE_SILENCE         | kFailed                                   |
// | its clock goes back, or stands still as long | kFailed                                   |
// | a position beyond its own ranges, NaN        | kFailed                                   |
// | another size or number than that of a state  | kFailed                                   |
// | it says an error, ends, or closes its socket | kFailed                                   |
// | its guard is gone                            | kFailed                                   |
// | stop() and no answer to the last message     | kFailed                                   |
// | this program stands still or vanishes        | see tools/devices/guard.cpp               |
//
// However it fails, its end is that of let_go.hpp.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "libcore/base/histogram.hpp"
#include "libcore/device/device.hpp"
#include "libcore/device/process_guard.hpp"
#include "libcore/device/process_protocol.h"

namespace hapgrid {

// Checks the messages of an adapter before anything uses them.

/// With fewer forces a second the adapter would take each of them away before the next comes.
inline constexpr double kSlowestProcessHz = 20;

/// The flaw of a greeting, to be read behind the adapter's name; empty when there is none.
/// @param size bytes that came, of which `greeting` has the first ones.
std::string greeting_flaw(const hapgrid_device_greeting& greeting, std::size_t size);
/// @param greeting without flaw. @param name stands for the name of a greeting that has none.
DeviceInfo device_info(const hapgrid_device_greeting& greeting, const std::string& name);

/// What an adapter says in place of a greeting or a state; empty when it says none.
std::string_view told_error(const char* message, std::size_t size) noexcept;

/// What went wrong with an adapter; the last five: with a state that it sent.
enum class AdapterFault {
  kNone,
  kSilent,
  kHeldOn,
  kGone,
  kTold,
  kStoodStill,
  kGuardGone,
  kSize,
  kNumber,
  kNotFinite,
  kOutside,
  kBackwards
};

/// The flaw of a state. Real-time safe. @param greeting without flaw. @param size bytes that came,
/// of which `state` has the first ones. @param number of the last force. @param time of the state
/// before.
AdapterFault state_flaw(const hapgrid_device_greeting& greeting, const hapgrid_device_state& state,
                        std::size_t size, std::uint32_t number, double time) noexcept;

class ProcessDevice : public Device {
 public:
  /// Starts the adapter, and waits 10 s at most for its greeting, then for a first state.
  /// @throw DeviceError; std::system_error(interrupted) when a signal came. The adapter has ended.
  explicit ProcessDevice(AdapterProgram program);
  /// Calls stop().
  ~ProcessDevice() override;

  DeviceInfo info() const override { return device_info(greeting_, guard_.name()); }
  /// Waits for a late answer, HAPGRID_DEVICE_SILENCE at most. The first call also asks for a state,
  /// since the one that the constructor saw may be old.
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3& force) noexcept override;
  void snap() noexcept override { snaps_ = true; }
  DeviceStatus stop() noexcept override;
  /// Sets the priority of those threads of the adapter that have no real-time priority. Threads
  /// that the adapter starts later do not inherit it.
  bool set_priority(int priority) noexcept override;
  /// Only for an adapter that says that it can share a processor, and where there is another one
  /// for the guard, which must not depend on what loop and adapter do.
  bool share_processor(int processor) noexcept override;
  std::string error() const override;

  /// Forces a second that the adapter can take.
  double rate_hz() const { return greeting_.rate; }
  /// Whether the adapter can be started to send zero force after it was killed.
  bool releases() const { return (greeting_.flags & HAPGRID_DEVICE_RELEASES) != 0; }
  pid_t adapter() const { return guard_.adapter(); }
  pid_t guard() const { return guard_.pid(); }
  /// From sending a force to its answer, in nanoseconds; 0 for an answer that was there when the
  /// next tick asked for it.
  const Histogram& delays() const { return delays_; }

 private:
  using Clock = std::chrono::steady_clock;

  void greet();
  std::string what() const;
  bool fail(AdapterFault fault) noexcept;
  bool ask(const Vec3& force) noexcept;
  ssize_t read_message(int flags) noexcept;
  bool is_told() const noexcept;
  bool end(AdapterFault fault) noexcept;
  bool receive() noexcept;
  bool read_answer() noexcept;
  bool beat(Clock::time_point now) noexcept;

  ProcessGuard guard_;
  hapgrid_device_greeting greeting_{};
  hapgrid_device_state state_{};
  Clock::time_point moved_on_;  // when the adapter's clock did
  Clock::time_point sent_, beat_;
  std::uint32_t number_ = 0;  // of the last force
  int priority_ = 0;          // that the adapter was given
  bool asked_ = false;        // its answer was not read yet
  bool snaps_ = false;        // with the next force
  Histogram delays_;
  std::atomic<AdapterFault> fault_ = AdapterFault::kNone;
  std::array<char, 512> message_{};  // the last one that came, of size_ bytes
  std::size_t size_ = 0;
  // For error():
  hapgrid_device_state wrong_{};  // that answered the force expected_
  std::uint32_t expected_ = 0;
  // stop() can come from the watchdog's thread, while the loop hangs or wakes up again.
  std::atomic<bool> stopped_ = false;
  std::atomic<DeviceStatus> stop_status_ = DeviceStatus::kFailed;
};

}  // namespace hapgrid
