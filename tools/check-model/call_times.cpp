#include "tools/check-model/call_times.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hapgrid {

CallTimes summary(std::vector<double> seconds) {
  CallTimes times;
  times.calls = seconds.size();
  if (seconds.empty()) return times;
  std::sort(seconds.begin(), seconds.end());
  const auto at = [&](double share) {
    return seconds[static_cast<std::size_t>(share * static_cast<double>(seconds.size() - 1))];
  };
  times.median = at(0.5);
  times.p99 = at(0.99);
  times.worst = seconds.back();
  times.mean =
      std::accumulate(seconds.begin(), seconds.end(), 0.0) / static_cast<double>(seconds.size());
  double squares = 0;
  for (const double s : seconds) squares += (s - times.mean) * (s - times.mean);
  const double n = static_cast<double>(seconds.size());
  const double error = 2 * std::sqrt(squares / std::max(1.0, n - 1) / n);
  times.usual = {times.mean, std::max(times.median / 2, times.mean - error), times.mean + error};
  return times;
}

double take_first_ones(std::vector<double>& seconds) {
  constexpr std::size_t kFirst = 3;
  constexpr double kSlow = 0.1, kSlower = 10;  // seconds; times the median
  double taken = 0;
  const double usual = summary(seconds).median;
  for (std::size_t k = 0; k < kFirst && seconds.size() > kFirst && seconds.front() > kSlow &&
                          seconds.front() > kSlower * usual;
       ++k) {
    taken += seconds.front();
    seconds.erase(seconds.begin());
  }
  return taken;
}

}  // namespace hapgrid
