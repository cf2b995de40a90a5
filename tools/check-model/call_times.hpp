// How long a model takes for its answers.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/check-model/estimate.hpp"

namespace hapgrid {

/// The durations of one kind of call, in seconds.
struct CallTimes {
  std::uint64_t calls = 0;
  double median = 0;
  double mean = 0;
  double p99 = 0;
  double worst = 0;
  Range usual;  ///< the mean, and two standard errors to either side
};

CallTimes summary(std::vector<double> seconds);

/// A model may load or compile what it needs when it is asked first: takes such conversions from
/// the others. Returns the seconds that they took.
double take_first_ones(std::vector<double>& seconds);

}  // namespace hapgrid
