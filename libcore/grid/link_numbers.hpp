// Which of the distinct links of a grid each record has: two bytes a record, and four only when
// there are more than 65,536 of them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <shared_mutex>
#include <span>

#include "libcore/base/large_array.hpp"

namespace hapgrid {

class LinkNumbers {
 public:
  LinkNumbers() = default;
  explicit LinkNumbers(std::size_t records) : narrow_(records) {}

  std::uint32_t operator[](std::size_t r) const { return wide_.empty() ? narrow_[r] : wide_[r]; }

  /// Sets those from record `first` on. Threads may do that at once for different records, all with
  /// the same mutex.
  void set(std::size_t first, std::span<const std::uint32_t> numbers, std::shared_mutex& mutex) {
    constexpr std::uint32_t kMostNarrow = 0xffff;
    std::uint32_t largest = 0;
    for (const std::uint32_t number : numbers) largest = std::max(largest, number);
    if (largest > kMostNarrow) widen(mutex);
    const std::shared_lock lock(mutex);
    if (wide_.empty())
      std::transform(numbers.begin(), numbers.end(), narrow_.data() + first,
                     [](std::uint32_t number) { return static_cast<std::uint16_t>(number); });
    else
      std::copy(numbers.begin(), numbers.end(), wide_.data() + first);
  }

 private:
  void widen(std::shared_mutex& mutex) {
    const std::unique_lock lock(mutex);
    if (!wide_.empty()) return;
    wide_ = LargeArray<std::uint32_t>(narrow_.size());
    // What was not set yet is copied, too, and set later.
    std::copy_n(narrow_.data(), narrow_.size(), wide_.data());
    narrow_ = {};
  }

  LargeArray<std::uint16_t> narrow_;
  LargeArray<std::uint32_t> wide_;
};

}  // namespace hapgrid
