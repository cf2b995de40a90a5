// Records of the frontier, and what their conversions reach.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// Records with the directions to be expanded, and room for what each conversion reaches. There are
/// enough records to keep the threads busy, and so few that the rows reached stay near the caches.
class Batch {
 public:
  /// One conversion: of a record of the batch, in a direction.
  struct Item {
    std::uint16_t record;
    std::uint16_t direction;
  };

  explicit Batch(const GridSpec& spec)
      : n_(spec.state_size),
        row_size_(spec.row_size()),
        capacity_(std::clamp<std::size_t>(kBytes / (sizeof(double) * kDirections * row_size_), 1,
                                          kMaxRecords)),
        sources_(std::make_unique_for_overwrite<Source[]>(capacity_)),
        states_(std::make_unique_for_overwrite<double[]>(capacity_ * n_)),
        reached_(std::make_unique_for_overwrite<double[]>(capacity_ * kDirections * row_size_)),
        items_(std::make_unique_for_overwrite<Item[]>(capacity_ * kDirections)) {}

  std::size_t size() const { return size_; }
  bool is_full() const { return size_ == capacity_; }
  void clear() { size_ = count_ = 0; }

  /// Adds a record to a batch that is not full. `todo` are the directions to expand, `state` the
  /// numbers of its state.
  void add(PointIndex point, Level level, const double* state, DirectionMask todo) {
    sources_[size_] = {point, todo, level};
    std::copy_n(state, n_, &states_[size_ * n_]);
    for (DirectionMask left = todo; left; left &= left - 1)
      items_[count_++] = {static_cast<std::uint16_t>(size_),
                          static_cast<std::uint16_t>(std::countr_zero(left))};
    ++size_;
  }

  PointIndex point(std::size_t i) const { return sources_[i].point; }
  Level level(std::size_t i) const { return sources_[i].level; }
  DirectionMask todo(std::size_t i) const { return sources_[i].todo; }
  const double* state(std::size_t i) const { return &states_[i * n_]; }
  /// What the conversions of a record reach: 26 rows of row_size() numbers.
  double* reached(std::size_t i) { return &reached_[i * kDirections * row_size_]; }

  /// The conversions of all records, ascending by (record, direction).
  std::size_t conversions() const { return count_; }
  Item conversion(std::size_t c) const { return items_[c]; }

 private:
  static constexpr std::size_t kBytes = 8 << 20;
  static constexpr std::size_t kMaxRecords = 2048;

  struct Source {
    PointIndex point;
    DirectionMask todo;
    Level level;
  };

  std::uint32_t n_;
  std::uint32_t row_size_;
  std::size_t capacity_;
  std::size_t size_ = 0;
  std::size_t count_ = 0;  // conversions
  // Not initialised: a small frontier touches little of it.
  std::unique_ptr<Source[]> sources_;
  std::unique_ptr<double[]> states_;   // capacity x n
  std::unique_ptr<double[]> reached_;  // capacity x 26 x row_size
  std::unique_ptr<Item[]> items_;      // capacity x 26
};

}  // namespace hapgrid
