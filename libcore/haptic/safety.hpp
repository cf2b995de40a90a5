// The safety core: the one thing between a computed force and the hand.
//
// Every force goes through apply() before a device sees it, whatever computed it. The stages stand
// in apply() in the order in which they act, each with its bit of state here and its bound in
// SafetyLimits; a fault at any of them latches the output at zero, because a force that comes back
// by itself after a fault is a kick. Alternatives: a clamp in each device (forgotten in the next
// one) or per axis (turns the force).
#pragma once

#include "libcore/grid/box.hpp"

namespace hapgrid {

struct SafetyLimits {
  double max_force = 3;  ///< newtons, of the magnitude; a small desktop device holds some 3 N
};

/// What apply() let through.
struct SafeForce {
  Vec3 force{0, 0, 0};   ///< newtons, to be sent
  bool clamped = false;  ///< the magnitude was above the limit
  bool faulted = false;  ///< the output is latched at zero
};

/// For one thread. Real-time safe after construction.
class SafetyCore {
 public:
  /// @throw Error when a limit is not finite or is negative.
  explicit SafetyCore(const SafetyLimits& limits = {});

  /// The force to send instead of `raw` (newtons): within the limit in magnitude and in the
  /// direction of `raw`, unchanged where it was within; zero from the first one on that is not
  /// finite, until reset().
  SafeForce apply(const Vec3& raw) noexcept;

  /// Latches the output at zero: for a fault that is seen elsewhere.
  void trip() noexcept { faulted_ = true; }
  bool faulted() const noexcept { return faulted_; }
  void reset() noexcept { faulted_ = false; }

 private:
  SafetyLimits limits_;
  bool faulted_ = false;
};

}  // namespace hapgrid
