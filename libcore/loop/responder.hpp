// What a tick of the haptic loop computes between the device's position and the force that it gets
// (Algorithm 2, lines 4 to 9): the HIP, its cell and state, the force, the safety core. It knows no
// time, so the page that plays a grid by itself has the same.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "libcore/device/device.hpp"
#include "libcore/follow/traversal.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/loop/mapping.hpp"
#include "libcore/loop/safety.hpp"

namespace hapgrid {

/// Ticks in a second of play when the loop is not paced.
inline constexpr double kUnpacedHz = 1000;

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
    if (has_last_hip_ && scale > 0) speed = length_of(hip - last_hip_) / (scale * dt);
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

}  // namespace hapgrid
