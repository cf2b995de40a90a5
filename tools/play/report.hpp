// The report of a play: lines for people, and JSON for machines.
#pragma once

#include <string>

#include "libcore/follow/beside.hpp"
#include "libcore/loop/loop.hpp"
#include "tools/play/publisher.hpp"

namespace hapgrid {

/// What a report contains beside the loop's summary.
struct RunFacts {
  std::string model = {};
  std::string device = {};
  std::string traversal = {};
  std::string force = {};
  double rate_hz = 0;                   ///< 0: not paced
  const Beside* beside = nullptr;       ///< null: the grid alone decides
  std::string realtime = {};            ///< see Realtime::got()
  const FrameCounts* frames = nullptr;  ///< null: no frames were written
  const Histogram* answers = nullptr;   ///< ProcessDevice::delays(); null: not an adapter's device
  double declared_delay = 0;            ///< safety.delay, in ticks
  int exit_code = 0;
};

/// Prints the lines on standard error.
void print_summary(const LoopSummary& summary, const RunFacts& facts);
/// @throw std::system_error
void write_report(const std::string& file, const LoopSummary& summary, const RunFacts& facts);

/// The ticks from a force to its answer, beyond the one that every answer has, of all but one
/// answer in ten.
double answer_delay_ticks(const RunFacts& facts);

/// "p50 12, p99 34, p99.9 56, max 78 us"
std::string quantiles_text(const Histogram& histogram);

}  // namespace hapgrid
