// The haptic loop (Algorithm 2, lines 3 to 10): read the HIP, locate its cell, switch, interpolate,
// compute the force, limit it, send it.
//
// The contract of one tick: nothing in here allocates, locks, throws, or does input or output.
// Force function and sink are the caller's types, taken as templates: haptic knows no models, and
// no call goes through a std::function. Of devices it knows the interface alone. Every way out of
// the loop, also an exception in one of them, has sent a zero force.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "libcore/device/device.hpp"
#include "libcore/haptic/safety.hpp"
#include "libcore/haptic/traversal.hpp"

namespace hapgrid {

/// When ticks are due. Paced: at start + k / rate, absolute, so that no error adds up; a tick that
/// is missed is skipped and counted, never caught up.
class Pacer {
 public:
  /// @param rate_hz ticks a second; 0 is not paced: each tick is due at once.
  explicit Pacer(double rate_hz) : rate_hz_(rate_hz) {}

  /// Waits for the next tick and returns its number k; returns early when `stop` becomes nonzero
  /// through a signal's handler. Real-time safe.
  std::uint64_t wait(const std::atomic<int>& stop) noexcept;

  std::uint64_t missed() const { return missed_; }

 private:
  /// The tick in whose period `nanoseconds` after the start lies.
  std::uint64_t tick_at(std::int64_t nanoseconds) const noexcept;

  double rate_hz_;
  bool started_ = false;
  std::int64_t start_ns_ = 0;  // CLOCK_MONOTONIC
  std::uint64_t next_ = 0;
  std::uint64_t missed_ = 0;
};

/// One tick as the loop's sink sees it; the references hold until the sink returns.
struct Tick {
  std::uint64_t number;  ///< counts the skipped ones, too
  const Vec3& hip;       ///< as it was read
  const StepResult& step;
  const SafeForce& force;  ///< as it was sent
  const Traversal& traversal;
};

enum class LoopEnd {
  kDeviceEnd,     ///< the device has no more positions
  kStopped,       ///< the stop flag
  kDeviceFailed,  ///< read or send failed
};

/// What happened, in ticks unless it says otherwise.
struct LoopSummary {
  LoopEnd end = LoopEnd::kStopped;
  bool zero_sent = false;  ///< the device took the last zero force
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0;
  std::uint64_t face_switches = 0;    ///< switches
  std::uint64_t edge_switches = 0;    ///< switches
  std::uint64_t vertex_switches = 0;  ///< switches
  std::uint64_t level_changed = 0;
  std::uint64_t outside = 0;
  std::uint64_t split = 0;
  std::uint64_t lagging = 0;
  std::uint64_t not_finite = 0;
  std::uint64_t blocked = 0;
  std::uint64_t clamped = 0;
  std::uint64_t faulted = 0;

  void count(const StepResult& step, const SafeForce& force) noexcept;
};

namespace loop_detail {

template <class Force, class Sink>
void drive(Device& device, Traversal& traversal, SafetyCore& safety, Force& force, Sink& sink,
           const std::atomic<int>& stop, double rate_hz, LoopSummary& summary) {
  Pacer pacer(rate_hz);
  for (;;) {
    const std::uint64_t number = pacer.wait(stop);
    summary.missed = pacer.missed();
    if (stop.load(std::memory_order_relaxed) != 0) {
      summary.end = LoopEnd::kStopped;
      return;
    }
    DeviceInput input;
    const DeviceStatus read = device.read(input);
    if (read != DeviceStatus::kOk) {
      summary.end = read == DeviceStatus::kEnd ? LoopEnd::kDeviceEnd : LoopEnd::kDeviceFailed;
      return;
    }
    const Vec3& hip = input.position;
    const StepResult step = traversal.step(hip);
    // A state that is not the HIP's gives a stale force: a device that reports NaN, or a grid that
    // is not playable, is a fault like a force that is not finite.
    if (!step.usable()) safety.trip();
    const SafeForce safe =
        safety.apply(safety.faulted() ? Vec3{} : force(traversal.position(), traversal.row()));
    if (device.send(safe.force) != DeviceStatus::kOk) {
      summary.end = LoopEnd::kDeviceFailed;
      return;
    }
    summary.count(step, safe);
    sink(Tick{number, hip, step, safe, traversal});
  }
}

}  // namespace loop_detail

/// Drives `device` until it ends or fails or `stop` is nonzero.
/// @param force  Vec3 (const Vec3& x, std::span<const double> row): the force in newtons on a HIP
/// at
///               x, clamped to the box; the row begins with the state. Real-time safe.
/// @param sink   void (const Tick&), after the force was sent; real-time safe when paced.
/// @param rate_hz ticks a second, 0 for as fast as possible.
/// @throw whatever force and sink throw, after a zero force was sent.
template <class Force, class Sink>
LoopSummary run_loop(Device& device, Traversal& traversal, SafetyCore& safety, Force&& force,
                     Sink&& sink, const std::atomic<int>& stop, double rate_hz = 0) {
  LoopSummary summary;
  try {
    loop_detail::drive(device, traversal, safety, force, sink, stop, rate_hz, summary);
  } catch (...) {
    static_cast<void>(device.stop());  // the exception is what the caller will hear about
    throw;
  }
  summary.zero_sent = device.stop() == DeviceStatus::kOk;
  return summary;
}

}  // namespace hapgrid
