// A histogram of whole numbers from 0 on, such as durations in nanoseconds or forces in
// nanonewtons, that a real-time thread can add to. Its bins are counters in an array; a bin is at
// most 1/128 of its values wide (the scheme of HDR histograms).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace hapgrid {

class Histogram {
 public:
  /// Adds a value; a negative one counts as 0. Real-time safe.
  void add(std::int64_t value) noexcept;

  /// Adds all values of another histogram.
  void add(const Histogram& other) noexcept;

  std::uint64_t count() const { return count_; }
  std::int64_t max() const { return max_; }
  /// The quantile `p` in (0, 1], as the upper edge of its bin: not below the true quantile, at most
  /// 1/128 above it, and never above max(). 0 when nothing was added.
  std::int64_t quantile(double p) const;

  /// Calls use(from, to, count) for each bin that is not empty, ascending: `count` of the values
  /// are in [from, to).
  template <class Use>
  void for_each_bin(const Use& use) const {
    for (std::size_t i = 0; i < kBins; ++i)
      if (counts_[i] > 0)
        use(static_cast<std::int64_t>(lower_edge(i)), static_cast<std::int64_t>(lower_edge(i + 1)),
            counts_[i]);
  }

 private:
  static constexpr int kSubBits = 7;  // 128 bins to a doubling
  static constexpr std::size_t kBins = (64 - kSubBits) << kSubBits;

  static std::size_t bin(std::uint64_t value) noexcept;
  static std::uint64_t lower_edge(std::size_t bin) noexcept;

  std::array<std::uint64_t, kBins> counts_{};
  std::uint64_t count_ = 0;
  std::int64_t max_ = 0;
};

}  // namespace hapgrid
