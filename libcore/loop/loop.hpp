// The haptic loop (Algorithm 2, lines 3 to 10): read the device, map it to the HIP, locate its
// cell, switch, interpolate, compute the force, limit it, send it.
//
// The contract of one tick: nothing here allocates, locks, throws, logs, or asks the system for
// more than the time. The force function and the sink are template parameters, so haptic knows no
// models, and no call goes through a std::function. Every way out of the loop stops the device, an
// exception of the force function or the sink included: the device then has a zero force.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "libcore/base/histogram.hpp"
#include "libcore/device/device.hpp"
#include "libcore/follow/traversal.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/loop/mapping.hpp"
#include "libcore/loop/pacer.hpp"
#include "libcore/loop/safety.hpp"

namespace hapgrid {

/// Ticks in a second of play when the loop is not paced.
inline constexpr double kUnpacedHz = 1000;

struct LoopOptions {
  double rate_hz = 0;                       ///< ticks a second; 0: not paced, as fast as possible
  double unpaced_hz = kUnpacedHz;           ///< ticks in a second of play when not paced
  double spin_us = 0;                       ///< see Pacer
  std::uint64_t ticks = ~std::uint64_t{0};  ///< the loop ends before the tick of this number
  Clock* clock = nullptr;                   ///< of a test; null: the system's

  bool paced() const { return rate_hz > 0; }
  double tick_rate_hz() const { return paced() ? rate_hz : unpaced_hz; }
};

/// One tick as the loop's sink sees it; the references hold until the sink returns.
struct Tick {
  std::uint64_t number;  ///< ticks that were skipped are counted, too
  const DeviceInput& input;
  Vec3 hip;   ///< in the box's axes and the model's unit; may be outside the box
  Vec3 hand;  ///< the same of DeviceInput::hand; NaN without one
  const StepResult& step;
  Vec3 raw_force;   ///< newtons, as the model gave it; NaN where there was none or in a fault
  SafeForce force;  ///< as it was sent, in the box's axes
  const Traversal& traversal;
  std::int64_t lateness_ns = 0;  ///< from when the tick was due to when it began
  std::int64_t compute_ns = 0;   ///< from there to when the force was sent
  std::int64_t slew_ns = 0;      ///< since the last force was sent; 0: the schedule's periods
};

enum class LoopExit {
  kDeviceEnd,     ///< the device has no more positions
  kStopped,       ///< the stop flag
  kTicks,         ///< LoopOptions::ticks
  kDeviceFailed,  ///< read or send failed
};

/// What happened: counts of ticks, except where a comment says otherwise.
struct LoopSummary {
  LoopExit end = LoopExit::kStopped;
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
  Histogram lateness;                                 ///< all 0 when the loop is not paced
  Histogram compute;

  std::uint64_t count_of(SafetyAction action) const;
  void count(const Tick& tick) noexcept;
};

namespace loop_detail {

/// From the device's input to the force that is sent.
template <class Force>
class Responder {
 public:
  Responder(Mapping& mapping, Traversal& traversal, SafetyCore& safety, Force& force)
      : mapping_(mapping), traversal_(traversal), safety_(safety), force_(force) {}

  /// @param dt seconds since the tick before, by the schedule. @param missed ticks in between.
  /// @param slew_ns as Tick has it
  Tick respond(std::uint64_t number, const DeviceInput& input, double dt, std::uint64_t missed,
               std::int64_t slew_ns) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    const double slew_dt = slew_ns > 0 ? static_cast<double>(slew_ns) * 1e-9 : dt;
    const Vec3 hip = mapping_.hip(input, dt);
    const bool begins = input.begins || !begun_;
    if (begins) begin();
    // Like that of the reset button, the press alone counts.
    const bool next = input.next && !next_held_;
    next_held_ = input.next;
    const StepResult& step = begins ? traversal_.start(hip) : traversal_.step(hip, next);
    // The loop takes the press of the reset button alone: a button that was pressed before the
    // fault does not answer it. The clutch may be held: nobody wants a force meanwhile, and its
    // release starts a ramp.
    const bool reset = input.reset && !reset_held_;
    reset_held_ = input.reset;
    if ((reset || input.clutch) && safety_.faulted()) safety_.reset();
    // After a HIP of NaN, or a link that leads nowhere, the state is that of an earlier HIP, and so
    // is its force: that is a fault like a force that is not finite.
    const bool unusable = !step.usable();
    const bool chosen = step.chosen != kNoLevel;
    Vec3 raw_force{kNaN, kNaN, kNaN};
    if (!unusable) {
      // Also in a fault, because a force may depend on the steps before.
      const Vec3 asked = force_(std::as_const(traversal_));
      if (!safety_.faulted()) raw_force = asked;
    }
    const SafeForce force = safety_.apply({.force = raw_force,
                                           .dt = dt,
                                           .slew_dt = slew_dt,
                                           .missed = missed,
                                           .speed = unusable ? 0 : speed(hip, dt),
                                           .place = place(hip),
                                           .model_energy = unusable ? std::nullopt : model_energy(),
                                           .account = unusable ? std::nullopt : account(),
                                           .jumped = step.jumped() || step.split,
                                           .chosen = chosen,
                                           .outside_cells = mapping_.outside_cells(hip),
                                           .stalled = input.stalled,
                                           .clutch = input.clutch,
                                           .unusable = unusable});
    return {number, input, hip,    mapping_.place(input.hand), step, raw_force, force, traversal_,
            0,      0,     slew_ns};
  }

 private:
  void begin() {
    safety_.begin();
    has_last_hip_ = false;
    reset_held_ = next_held_ = false;
    begun_ = true;
  }

  /// In joules, where they are known.
  std::optional<double> model_energy() const {
    if constexpr (requires { force_.model_energy(traversal_); })
      return force_.model_energy(traversal_);
    return std::nullopt;
  }
  std::optional<double> account() const {
    if constexpr (requires { force_.account(traversal_); }) return force_.account(traversal_);
    return std::nullopt;
  }

  /// The HIP in metres of the hand.
  std::optional<Vec3> place(const Vec3& hip) const noexcept {
    const double scale = mapping_.scale();
    if (!(scale > 0)) return std::nullopt;
    return Vec3{hip[0] / scale, hip[1] / scale, hip[2] / scale};
  }

  /// Of the hand, in m/s; 0 where the scale is not known.
  double speed(const Vec3& hip, double dt) noexcept {
    const double scale = mapping_.scale();
    double speed = 0;
    if (has_last_hip_ && scale > 0) {
      const Vec3 way = hip - last_hip_;
      speed = std::hypot(way[0], way[1], way[2]) / (scale * dt);
    }
    last_hip_ = hip;
    has_last_hip_ = true;
    return std::min(speed, std::numeric_limits<double>::max());
  }

  Mapping& mapping_;
  Traversal& traversal_;
  SafetyCore& safety_;
  Force& force_;
  Vec3 last_hip_{0, 0, 0};
  bool has_last_hip_ = false;
  bool begun_ = false;
  bool reset_held_ = false;
  bool next_held_ = false;
};

template <class Force, class Sink>
void drive(Device& device, Mapping& mapping, Traversal& traversal, SafetyCore& safety, Force& force,
           Sink& sink, const std::atomic<int>& stop, std::atomic<std::uint64_t>& heartbeat,
           const LoopOptions& options, LoopSummary& summary) {
  const double period = 1 / options.tick_rate_hz();
  Clock system;
  Clock& clock = options.clock ? *options.clock : system;
  Pacer pacer(clock, options.rate_hz, options.spin_us);
  Responder<Force> responder(mapping, traversal, safety, force);
  std::uint64_t recorded_misses = 0;
  std::uint64_t last = 0;
  std::int64_t sent_ns = 0;
  for (;;) {
    const std::uint64_t due = pacer.wait(stop);
    heartbeat.fetch_add(1, std::memory_order_relaxed);
    if (stop.load(std::memory_order_relaxed) != 0) {
      summary.end = LoopExit::kStopped;
      return;
    }
    if (due >= options.ticks) {
      summary.end = LoopExit::kTicks;
      return;
    }
    DeviceInput input;
    const DeviceStatus read = device.read(input);
    if (read != DeviceStatus::kOk) {
      summary.end = read == DeviceStatus::kEnd ? LoopExit::kDeviceEnd : LoopExit::kDeviceFailed;
      return;
    }
    recorded_misses += input.missed;
    const std::uint64_t number = due + recorded_misses;
    const std::uint64_t passed = summary.ticks > 0 ? number - last : 1;
    last = number;

    // After a late answer of the device the next tick is soon due. Then the force must not change
    // by what the slew limit allows for the periods of the schedule, but for the time that really
    // lies between two forces: from when the last one was sent to when this tick began.
    const std::int64_t slew_ns = options.paced() && summary.ticks > 0
                                     ? std::max<std::int64_t>(1, pacer.began_ns() - sent_ns)
                                     : input.slew_ns;
    Tick tick =
        responder.respond(number, input, static_cast<double>(passed) * period, passed - 1, slew_ns);
    if (tick.step.snapped && !safety.faulted()) device.snap();
    if (device.send(mapping.to_device(tick.force.force)) != DeviceStatus::kOk) {
      summary.end = LoopExit::kDeviceFailed;
      return;
    }
    tick.lateness_ns = pacer.lateness_ns();
    sent_ns = clock.now();
    tick.compute_ns = sent_ns - pacer.began_ns();
    summary.count(tick);
    sink(tick);
    summary.missed += passed - 1;
    summary.overruns += passed > 1;
  }
}

}  // namespace loop_detail

/// Drives `device` until it ends or fails or `stop` is nonzero.
/// @param force  Vec3 (const Traversal&): the force in newtons at the traversal's position, asked
///               after each usable step, of which it knows by Traversal::last_step(). Real-time
///               safe. It may have a member double model_energy(const Traversal&): the energy in
///               joules that the hand can get from the model there, and a member
///               std::optional<double> account(const Traversal&), as NodeForce has one, in joules;
///               both are asked after the force.
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
