// What the sessions of a simulated device are judged by.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "libcore/base/histogram.hpp"
#include "libcore/loop/loop.hpp"
#include "libcore/model/fields.hpp"
#include "tests/bench/simulated.hpp"

namespace hapgrid {

/// How far forces are from those of the model, over ticks in contact.
class ForceError {
 public:
  void add(double newtons) noexcept;
  void add(const ForceError& other) noexcept;
  std::uint64_t ticks() const { return nanonewtons_.count(); }
  double mean() const;  ///< newtons; 0 without a tick
  double p99() const;   ///< newtons; at most 1/128 too large

 private:
  double sum_ = 0;
  Histogram nanonewtons_;
};

/// One session. The energies are exact, of the force as it was in effect.
struct SessionFigures {
  double stored_mj = 0;    ///< the model's energy where the ramp rose; 0 where it is not known
  double given_mj = 0;     ///< what the device gave to the hand until the end; below 0: it took it
  double returned_mj = 0;  ///< the most that it gave at any time beyond what was stored
  std::uint64_t holds = 0;
  double oscillation_mm = 0;  ///< the worst hold's: peak to peak on the worst axis
  double largest_step_n = 0;  ///< the largest change of the force that was sent, between ticks
  std::uint64_t contact = 0;  ///< ticks that the errors are of
  double sent_mean_n = 0, sent_p99_n = 0;  ///< error of the force as it was sent
  double raw_mean_n = 0, raw_p99_n = 0;    ///< error of the force before the safety core
};

/// Follows the sessions of a device, tick by tick.
class Sessions {
 public:
  struct Setup {
    double rate_hz = 1000;
    double gain = 1;  ///< of the safety core: what the model's newton is on the device
  };
  /// @param truth what the model itself does along the same positions; null: no comparison.
  Sessions(const SimulatedDevice& device, const SafetyCore& safety, const Fields& fields,
           const Setup& setup, Traversal* truth);

  void add(const Tick& tick);
  /// Called once, after the last tick.
  void finish();

  const std::vector<SessionFigures>& sessions() const { return sessions_; }
  const ForceError& sent_error() const { return sent_; }
  const ForceError& raw_error() const { return raw_; }
  bool has_truth() const { return truth_ != nullptr; }

 private:
  void begin();
  void end();
  void note_position();
  void judge_rest();
  void compare(const Tick& tick);

  const SimulatedDevice& device_;
  const SafetyCore& safety_;
  const Fields& fields_;
  Setup setup_;
  Traversal* truth_;
  std::vector<SessionFigures> sessions_;
  Vec3 last_sent_{0, 0, 0};
  Vec3 last_target_{0, 0, 0};
  std::uint64_t rest_ = 0;       // ticks for which the target has been where it is
  std::vector<Vec3> positions_;  // of the last second, a ring
  std::size_t next_ = 0;
  ForceError session_sent_, session_raw_;
  ForceError sent_, raw_;
};

/// The lines of the summary.
std::string sessions_text(const Sessions& sessions);
nlohmann::ordered_json sessions_json(const Sessions& sessions);
/// A line of columns for each session, separated by tabs; the first line names them.
std::string sessions_table(const Sessions& sessions);

}  // namespace hapgrid
