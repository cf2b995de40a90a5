// What play says of a run: lines for people, and JSON for machines.
#pragma once

#include <string>

#include "libcore/haptic/loop.hpp"
#include "libcore/scene/publisher.hpp"

namespace hapgrid {

/// What a report needs beside the loop's summary.
struct RunFacts {
  std::string model = {};
  std::string device = {};
  double rate_hz = 0;                   ///< 0: no pace
  std::string realtime = {};            ///< what was got
  const FrameCounts* frames = nullptr;  ///< none: no frames were wanted
  int exit_code = 0;
};

/// On standard error.
void print_summary(const LoopSummary& summary, const RunFacts& facts);
/// @throw std::system_error
void write_report(const std::string& file, const LoopSummary& summary, const RunFacts& facts);

/// "p50 12, p99 34, p99.9 56, max 78 us"
std::string quantiles_text(const Histogram& histogram);

}  // namespace hapgrid
