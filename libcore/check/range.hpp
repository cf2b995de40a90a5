// A share of the work.
#pragma once

#include <cstdint>

namespace hapgrid {

/// [begin, end)
struct Range {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;

  std::uint64_t size() const { return end - begin; }
};

/// The K-th of N parts of something, 1 <= K <= N < 2^32. Parts are contiguous, so that what was
/// found in them can be joined in the order of the whole.
struct CheckPart {
  std::uint64_t number = 1;
  std::uint64_t of = 1;

  bool is_first() const { return number == 1; }
  /// Its share of [0, count), count < 2^32; empty where there are fewer than parts.
  Range share(std::uint64_t count) const {
    return {count * (number - 1) / of, count * number / of};
  }
};

}  // namespace hapgrid
