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
#include <cstdint>

#include "libcore/base/histogram.hpp"
#include "libcore/device/device.hpp"
#include "libcore/loop/pacer.hpp"
#include "libcore/loop/responder.hpp"

namespace hapgrid {

struct LoopOptions {
  double rate_hz = 0;                       ///< ticks a second; 0: not paced, as fast as possible
  double unpaced_hz = kUnpacedHz;           ///< ticks in a second of play when not paced
  double spin_us = 0;                       ///< see Pacer
  std::uint64_t ticks = ~std::uint64_t{0};  ///< the loop ends before the tick of this number
  Clock* clock = nullptr;                   ///< of a test; null: the system's

  bool paced() const { return rate_hz > 0; }
  double tick_rate_hz() const { return paced() ? rate_hz : unpaced_hz; }
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
