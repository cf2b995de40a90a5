// The haptic loop (Algorithm 2, lines 3 to 10): read the device, map it to the HIP, locate its
// cell, switch, interpolate, compute the force, limit it, send it.
//
// The contract of one tick: nothing in here allocates, locks, throws, logs, or asks the system for
// more than the time. Force function and sink are the caller's types, taken as templates: haptic
// knows no models, and no call goes through a std::function. Of devices it knows the interface
// alone. Every way out of the loop, also an exception in one of them, has stopped the device, which
// is a zero force that was waited for.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "libcore/device/device.hpp"
#include "libcore/haptic/histogram.hpp"
#include "libcore/haptic/mapping.hpp"
#include "libcore/haptic/pacer.hpp"
#include "libcore/haptic/safety.hpp"
#include "libcore/haptic/traversal.hpp"

namespace hapgrid {

/// What a tick is worth without a pace: ticks a second.
inline constexpr double kUnpacedHz = 1000;

struct LoopOptions {
  double rate_hz = 0;                       ///< ticks a second; 0: as fast as possible
  double unpaced_hz = kUnpacedHz;           ///< what time a tick is without a pace
  double spin_us = 0;                       ///< see Pacer
  std::uint64_t ticks = ~std::uint64_t{0};  ///< the loop ends before the tick of this number
};

/// One tick as the loop's sink sees it; the references hold until the sink returns.
struct Tick {
  std::uint64_t number;  ///< counts the skipped ones, too
  const DeviceInput& input;
  const Vec3& hip;  ///< in the box's axes and the model's unit; may be outside the box
  const StepResult& step;
  const Vec3& raw_force;   ///< newtons, as the model gave it; NaN where it was not asked
  const SafeForce& force;  ///< as it was sent, but for the turn into the device's axes
  const Traversal& traversal;
  std::int64_t lateness_ns;  ///< from when the tick was due to when it began
  std::int64_t compute_ns;   ///< from there to when the force was sent
};

enum class LoopEnd {
  kDeviceEnd,     ///< the device has no more positions
  kStopped,       ///< the stop flag
  kTicks,         ///< LoopOptions::ticks
  kDeviceFailed,  ///< read or send failed
};

/// What happened, in ticks unless it says otherwise.
struct LoopSummary {
  LoopEnd end = LoopEnd::kStopped;
  bool zero_sent = false;  ///< the device took the last zero force
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0;
  std::uint64_t overruns = 0;         ///< times that ticks were missed
  std::uint64_t face_switches = 0;    ///< switches
  std::uint64_t edge_switches = 0;    ///< switches
  std::uint64_t vertex_switches = 0;  ///< switches
  std::uint64_t level_changed = 0;
  std::uint64_t outside = 0;
  std::uint64_t split = 0;
  std::uint64_t lagging = 0;
  std::uint64_t not_finite = 0;
  std::uint64_t blocked = 0;
  std::array<std::uint64_t, kSafetyActions> acted{};  ///< by SafetyAction
  double largest_raw = 0;                             ///< newtons, of what the model gave
  double largest_force = 0;                           ///< newtons, of what was sent
  Histogram lateness;                                 ///< without a pace all 0
  Histogram compute;

  std::uint64_t count_of(SafetyAction action) const;
  void count(const Tick& tick) noexcept;
};

namespace loop_detail {

/// How fast the hand is, from where the HIP is; m/s.
class Speed {
 public:
  /// @param scale model's units for a metre; 0: not known, the speed is 0.
  explicit Speed(double scale) : scale_(scale) {}
  double next(const Vec3& hip, double dt) noexcept;

 private:
  double scale_;
  bool any_ = false;
  Vec3 last_{0, 0, 0};
};

template <class Force, class Sink>
void drive(Device& device, Mapping& mapping, Traversal& traversal, SafetyCore& safety, Force& force,
           Sink& sink, const std::atomic<int>& stop, std::atomic<std::uint64_t>& heartbeat,
           const LoopOptions& options, LoopSummary& summary) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const double period = 1 / (options.rate_hz > 0 ? options.rate_hz : options.unpaced_hz);
  Pacer pacer(options.rate_hz, options.spin_us);
  Speed speed(mapping.scale());
  std::uint64_t recorded_misses = 0;
  std::uint64_t last = 0;
  bool reset_held = false;
  for (;;) {
    const std::uint64_t due = pacer.wait(stop);
    heartbeat.fetch_add(1, std::memory_order_relaxed);
    if (stop.load(std::memory_order_relaxed) != 0) {
      summary.end = LoopEnd::kStopped;
      return;
    }
    if (due >= options.ticks) {
      summary.end = LoopEnd::kTicks;
      return;
    }
    DeviceInput input;
    const DeviceStatus read = device.read(input);
    if (read != DeviceStatus::kOk) {
      summary.end = read == DeviceStatus::kEnd ? LoopEnd::kDeviceEnd : LoopEnd::kDeviceFailed;
      return;
    }
    recorded_misses += input.missed;
    const std::uint64_t number = due + recorded_misses;
    const std::uint64_t passed = summary.ticks > 0 ? number - last : 1;
    const double dt = static_cast<double>(passed) * period;
    last = number;

    const Vec3 hip = mapping.hip(input, dt);
    const StepResult step = traversal.step(hip);
    // A press from before the fault is no answer to it. The clutch may be held: no force is wanted
    // meanwhile, and its release is a ramp.
    const bool reset = input.reset && !reset_held;
    reset_held = input.reset;
    if ((reset || input.clutch) && safety.faulted()) safety.reset();
    // A state that is not the HIP's gives a stale force: a device that reports NaN, or a grid that
    // is not playable, is a fault like a force that is not finite.
    const bool unusable = !step.usable();
    Vec3 raw{kNaN, kNaN, kNaN};
    if (!unusable && !safety.faulted()) raw = force(traversal.position(), traversal.row());
    const SafeForce safe = safety.apply({.force = raw,
                                         .dt = dt,
                                         .missed = passed - 1,
                                         .speed = unusable ? 0 : speed.next(hip, dt),
                                         .outside_cells = mapping.outside_cells(hip),
                                         .level_changed = step.level_changed,
                                         .stalled = input.stalled,
                                         .clutch = input.clutch,
                                         .unusable = unusable});
    if (device.send(mapping.to_device(safe.force)) != DeviceStatus::kOk) {
      summary.end = LoopEnd::kDeviceFailed;
      return;
    }
    const Tick tick{number,
                    input,
                    hip,
                    step,
                    raw,
                    safe,
                    traversal,
                    pacer.lateness_ns(),
                    monotonic_ns() - pacer.began_ns()};
    summary.count(tick);
    sink(tick);
    summary.missed += passed - 1;
    summary.overruns += passed > 1;
  }
}

}  // namespace loop_detail

/// Drives `device` until it ends or fails or `stop` is nonzero.
/// @param force  Vec3 (const Vec3& x, std::span<const double> row): the force in newtons on a HIP
///               at x, clamped to the box; the row begins with the state. Real-time safe.
/// @param sink   void (const Tick&), after the force was sent; real-time safe when paced.
/// @param heartbeat counts the ticks as they begin, for a watchdog in another thread.
/// @throw whatever force and sink throw, after a zero force was sent.
template <class Force, class Sink>
LoopSummary run_loop(Device& device, Mapping& mapping, Traversal& traversal, SafetyCore& safety,
                     Force&& force, Sink&& sink, const std::atomic<int>& stop,
                     std::atomic<std::uint64_t>& heartbeat, const LoopOptions& options = {}) {
  LoopSummary summary;
  try {
    loop_detail::drive(device, mapping, traversal, safety, force, sink, stop, heartbeat, options,
                       summary);
  } catch (...) {
    static_cast<void>(device.stop());  // the exception is what the caller will hear about
    throw;
  }
  summary.zero_sent = device.stop() == DeviceStatus::kOk;
  return summary;
}

}  // namespace hapgrid
