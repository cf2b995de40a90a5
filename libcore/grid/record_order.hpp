// The order of a grid's records.
#pragma once

#include <cstdint>
#include <string>

#include "libcore/base/error.hpp"
#include "libcore/grid/spec.hpp"

namespace hapgrid {

/// Checks record after record that each point is in the box, that points ascend, and that the
/// levels of a point are 0, 1, 2, ...
class RecordOrder {
 public:
  /// @param spec outlives this.
  explicit RecordOrder(const GridSpec& spec) : spec_(spec), points_(spec.box.points()) {}

  /// @param record its number, for messages. @returns whether it begins another point than the
  /// record before. @throw FormatError
  bool next(std::uint64_t record, PointIndex point, std::uint32_t level) {
    const bool is_other = any_ && point != point_;
    if (point >= points_ || (is_other && point < point_))
      throw FormatError("grid: record " + std::to_string(record) + " has point " +
                        std::to_string(point) + ", outside the box or out of order");
    if (is_other) expected_ = 0;
    if (level != expected_ || level >= spec_.max_levels)
      throw FormatError("grid: point " + std::to_string(point) + ": level " +
                        std::to_string(level) + " where level " + std::to_string(expected_) +
                        " of at most " + std::to_string(spec_.max_levels) + " was expected");
    any_ = true;
    point_ = point;
    ++expected_;
    return is_other;
  }

 private:
  const GridSpec& spec_;
  std::uint64_t points_;
  std::uint32_t expected_ = 0;
  bool any_ = false;
  PointIndex point_ = 0;
};

/// A header can claim any number of points in a few bytes. A finished grid has a record at each of
/// them; a grid of more than 2^24 points must have a record at least at one in a thousand.
/// @throw FormatError
void require_enough_records(const Box& box, std::uint64_t records);

}  // namespace hapgrid
