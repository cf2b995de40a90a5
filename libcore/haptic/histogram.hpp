// Durations, counted so that a tick can do it: an array of counters whose bins grow with the value,
// each at most 1/64 of it wide (the scheme of HDR histograms, which Debian has for other languages
// only).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace hapgrid {

class Histogram {
 public:
  /// Real-time safe. Nanoseconds; below 0 counts as 0.
  void add(std::int64_t nanoseconds) noexcept;

  /// Everything that was added to another one.
  void add(const Histogram& other) noexcept;

  std::uint64_t count() const { return count_; }
  std::int64_t max() const { return max_; }
  /// The value that the part `p` in (0, 1] of all is not above: the upper edge of its bin, so not
  /// below the true one and at most 1/64 above it; 0 without values, never above max().
  std::int64_t quantile(double p) const;

  struct Bin {
    std::int64_t from;  ///< nanoseconds, inclusive
    std::int64_t to;    ///< exclusive
    std::uint64_t count;
  };
  /// The bins with something in them, ascending.
  std::vector<Bin> bins() const;

 private:
  static constexpr int kSubBits = 6;  // 64 bins to a doubling
  static constexpr std::size_t kBins = (64 - kSubBits) << kSubBits;

  static std::size_t bin(std::uint64_t value) noexcept;
  static std::uint64_t lower_edge(std::size_t bin) noexcept;

  std::array<std::uint64_t, kBins> counts_{};
  std::uint64_t count_ = 0;
  std::int64_t max_ = 0;
};

}  // namespace hapgrid
