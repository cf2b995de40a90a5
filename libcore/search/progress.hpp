// The progress of a search, and the request to stop it.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "libcore/base/error.hpp"

namespace hapgrid {

/// What a search has done so far. Another thread may read it meanwhile, to show it.
struct Progress {
  std::atomic<std::uint64_t> conversions{0};           ///< done in this run
  std::atomic<std::uint64_t> frontier_conversions{0};  ///< asked for by the current frontier
  std::atomic<std::uint64_t> frontier_done{0};         ///< of these, done
  std::atomic<std::uint64_t> frontier_records{0};
  std::atomic<std::uint64_t> records{0};  ///< records of the grid so far
  std::atomic<std::uint32_t> generation{0};
  /// Not 0 when the work must end soon. Null when nothing stops it. A signal's handler may set it.
  const std::atomic<int>* stop = nullptr;

  bool stopped() const { return stop && stop->load(std::memory_order_relaxed) != 0; }
};

/// Thrown by work that Progress::stop has ended.
class Stopped : public Error {
 public:
  explicit Stopped(const std::string& what_is_kept = "") : Error("interrupted" + what_is_kept) {}
};

}  // namespace hapgrid
