// A device that is a process: an adapter drives it, beside this program, and speaks the protocol of
// process_protocol.h.
//
// Problem. Most devices with three axes are driven by a closed library of their maker, which must
// not run in this program. Choice: each tick sends one force, and the next tick reads the one state
// that answers it. The answer has had a whole period to come, so that reading it does not wait. An
// adapter that is late makes the tick late, which the loop counts as for every other reason: each
// force was in effect, and each position is that after it, a tick old; the energy tank allows for
// that tick (TankTerms::delay). There are no queues, and no threads.
// Alternatives: an adapter that sends at its own rate (positions are fresher, but it must not block
// when this program stands still, and each adapter would have to get that right); to send and wait
// in the same tick (fresher by a period, and the loop waits for hardware in every tick).
//
// | what                                         | outcome                                     |
// |----------------------------------------------|---------------------------------------------|
// | no answer for HAPGRID_DEVICE_SILENCE         | kFailed; the adapter is killed              |
// | its clock goes back, or stands still as long | kFailed; it is told to let go               |
// | a position beyond its own ranges, NaN        | kFailed; it is told to let go               |
// | another size or number than that of a state  | kFailed; it is told to let go               |
// | it ends, or closes its socket                | kFailed; what it started is killed          |
// | stop() and no answer to the last message     | kFailed after a second; it is killed        |
// | this program stands still or vanishes        | see ProcessGuard                            |
//
// An adapter that is told to let go, and does not confirm that within HAPGRID_DEVICE_SILENCE, is
// killed.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "libcore/device/device.hpp"
#include "libcore/device/process_guard.hpp"
#include "libcore/device/process_messages.hpp"

namespace hapgrid {

class ProcessDevice : public Device {
 public:
  /// Starts the adapter, and waits 10 s at most for its greeting, then for a first state.
  /// @param guard not started; it must live longer than this object.
  /// @throw DeviceError; std::system_error(interrupted) when a signal came. The adapter was told to
  /// end, or killed.
  explicit ProcessDevice(ProcessGuard& guard);
  /// Calls stop().
  ~ProcessDevice() override;

  DeviceInfo info() const override { return device_info(greeting_, guard_.name()); }
  /// Waits for a late answer, HAPGRID_DEVICE_SILENCE at most. The first call also asks for a state,
  /// since the one that the constructor saw may be old.
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3& force) noexcept override;
  DeviceStatus stop() noexcept override;
  /// Sets the priority of those threads of the adapter that have no real-time priority. Threads
  /// that the adapter starts later do not inherit it.
  bool set_priority(int priority) noexcept override;
  std::string error() const override;

  /// Forces a second that the adapter can take.
  double rate_hz() const { return greeting_.rate; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Fault { kNone, kSilent, kHeldOn, kGone, kFlaw, kStoodStill, kGuardLetGo };

  void greet();
  std::string what() const;
  std::string what_flaw() const;
  bool fail(Fault fault) noexcept;
  bool ask(const Vec3& force, bool end) noexcept;
  bool read_answer() noexcept;
  bool confirmed(Clock::time_point deadline) noexcept;
  void close(std::chrono::microseconds patience) noexcept;

  ProcessGuard& guard_;
  hapgrid_device_greeting greeting_{};
  hapgrid_device_state state_{};
  Clock::time_point moved_on_;  // when the adapter's clock did
  std::uint32_t number_ = 0;    // of the last force
  int priority_ = 0;            // that the adapter was given
  bool asked_ = false;          // its answer was not read yet
  Fault fault_ = Fault::kNone;
  // For error():
  StateFlaw flaw_ = StateFlaw::kNone;
  std::size_t size_ = 0;          // of the message that is no state
  hapgrid_device_state wrong_{};  // that answered the force expected_
  std::uint32_t expected_ = 0;
  std::string how_;  // the adapter ended
  bool stopped_ = false;
  DeviceStatus stop_status_ = DeviceStatus::kFailed;
};

}  // namespace hapgrid
