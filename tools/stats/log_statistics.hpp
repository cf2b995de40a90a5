// The figures of a session.
#pragma once

#include <array>
#include <cstdint>

#include "libcore/base/histogram.hpp"
#include "libcore/session/session.hpp"

namespace hapgrid {

/// The largest magnitude of a force.
struct LargestForce {
  double newtons = 0;
  std::uint64_t tick = 0;  ///< the first one that had it
  bool any = false;        ///< whether any force was finite
};

/// The work that the device does on the hand: the sum over all ticks of the force that was sent
/// times the motion of the HIP until the next tick, in newtons times the box's unit of length. It
/// is exact for a device whose force is in effect at once and holds until the next one.
class HandEnergy {
 public:
  explicit HandEnergy(const SessionHeader& header) : begins_(header.flag(kBeginsFlag)) {}

  void add(const TickRecord& tick);
  /// The work in all ticks; below 0 if the hand did more work than the device.
  double given() const { return given_; }
  /// The work since the hand began anew (kBeginsFlag), or since the first tick.
  double since_begin() const { return since_begin_; }
  /// The largest since_begin() so far, at least 0, and its tick.
  double returned() const { return returned_; }
  std::uint64_t returned_tick() const { return returned_tick_; }

 private:
  std::size_t begins_;  // kMaxFlags: there is no such flag
  bool any_ = false;
  TickRecord last_;
  double given_ = 0;
  double since_begin_ = 0;
  double returned_ = 0;
  std::uint64_t returned_tick_ = 0;
};

/// Counts of the ticks that were added, in order.
struct SessionStatistics {
  std::uint64_t ticks = 0;
  std::uint64_t first = 0;    ///< number
  std::uint64_t last = 0;     ///< number
  std::uint64_t skipped = 0;  ///< numbers between them without a tick: missed or dropped
  LargestForce raw;
  LargestForce sent;
  std::uint64_t not_computed = 0;                ///< ticks without a raw force
  std::array<std::uint64_t, kMaxFlags> flags{};  ///< ticks in which the flag was set
  Histogram lateness;
  Histogram compute;

  void add(const TickRecord& tick);
};

}  // namespace hapgrid
