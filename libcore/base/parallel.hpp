// Work on a whole grid in threads that leave no trace in the result.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <future>
#include <string>
#include <utility>
#include <vector>

namespace hapgrid {

/// As many as this program may use processors: those that it may run on (taskset, Slurm), but no
/// more than the quota of its control group, rounded up: in a container, time is all that is
/// limited. @param root the folder of /proc and /sys, with a "/" at its end
int all_threads(const std::string& root = "/");

/// Calls work(i) once for each i in [0, count), in `threads` threads, in no particular order.
/// @throw whatever `work` throws, when all threads have ended.
template <class Work>
void for_each_in_threads(std::size_t count, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t i; (i = next++) < count;) work(i);
  };
  std::vector<std::future<void>> others;
  const auto useful =
      static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(threads), count));
  for (int t = 1; t < useful; ++t) others.push_back(std::async(std::launch::async, run));
  run();
  for (std::future<void>& other : others) other.get();
}

/// Calls work(own, i) once for each i in [0, count), in a thread for each of `owns`, which is used
/// by that thread alone: a model.
template <class Owns, class Work>
void for_each_with_own(std::size_t count, Owns& owns, const Work& work) {
  std::atomic<std::size_t> next{0};
  for_each_in_threads(owns.size(), static_cast<int>(owns.size()), [&](std::size_t t) {
    for (std::size_t i; (i = next++) < count;) work(owns[t], i);
  });
}

/// Joins what was found in blocks by `sum.add(result)`, in ascending order.
template <class Result>
Result sum_of(std::vector<Result>&& results) {
  Result sum;
  for (Result& result : results) sum.add(std::move(result));
  return sum;
}

}  // namespace hapgrid
