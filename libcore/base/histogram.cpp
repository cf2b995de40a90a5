#include "libcore/base/histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hapgrid {

std::size_t Histogram::bin(std::uint64_t value) noexcept {
  constexpr std::uint64_t kSub = std::uint64_t{1} << kSubBits;
  if (value < kSub) return value;
  const int shift = std::bit_width(value) - 1 - kSubBits;
  return (static_cast<std::size_t>(shift + 1) << kSubBits) + ((value >> shift) - kSub);
}

std::uint64_t Histogram::lower_edge(std::size_t bin) noexcept {
  constexpr std::uint64_t kSub = std::uint64_t{1} << kSubBits;
  if (bin < kSub) return bin;
  const std::size_t shift = (bin >> kSubBits) - 1;
  return (kSub + (bin & (kSub - 1))) << shift;
}

void Histogram::add(std::int64_t value) noexcept {
  value = std::max<std::int64_t>(value, 0);
  ++counts_[bin(static_cast<std::uint64_t>(value))];
  ++count_;
  max_ = std::max(max_, value);
}

void Histogram::add(const Histogram& other) noexcept {
  for (std::size_t i = 0; i < kBins; ++i) counts_[i] += other.counts_[i];
  count_ += other.count_;
  max_ = std::max(max_, other.max_);
}

std::int64_t Histogram::quantile(double p) const {
  if (count_ == 0) return 0;
  const auto wanted = static_cast<std::uint64_t>(std::ceil(p * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < kBins; ++i) {
    seen += counts_[i];
    if (seen >= wanted && counts_[i] > 0)
      return std::min(max_, static_cast<std::int64_t>(lower_edge(i + 1) - 1));
  }
  return max_;
}

}  // namespace hapgrid
