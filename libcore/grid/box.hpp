// The area of interest A (Sect. 2.1): a rectangular box of grid points with one spacing.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "libcore/grid/direction.hpp"

namespace hapgrid {

/// A grid point: p = i + nx (j + ny k), i fastest. A box has fewer than 2^32 points.
using PointIndex = std::uint32_t;

/// Three coordinates in the model's unit of length.
using Vec3 = std::array<double, 3>;
/// The integer coordinates (i, j, k) of a grid point.
using GridCoordinates = std::array<std::uint32_t, 3>;

/// Lengths are in the model's unit of length.
struct Box {
  Vec3 origin{0, 0, 0};  ///< position of the point (0, 0, 0)
  double spacing = 1;    ///< h, the distance of neighbours along each axis
  GridCoordinates counts{1, 1, 1};

  /// @throw Error when a value is not finite, the spacing not positive, a count zero, or the
  /// number of points not below 2^32.
  void validate() const;

  std::uint64_t points() const { return std::uint64_t{counts[0]} * counts[1] * counts[2]; }
  PointIndex index(const GridCoordinates& c) const {
    return c[0] + counts[0] * (c[1] + counts[1] * c[2]);
  }
  GridCoordinates coordinates(PointIndex p) const {
    const PointIndex row = p / counts[0];
    return {p - row * counts[0], row % counts[1], row / counts[1]};
  }
  /// The one formula for a position; everything that evaluates a model uses it, so that results
  /// agree to the last bit.
  Vec3 position(const GridCoordinates& c) const {
    return {origin[0] + spacing * c[0], origin[1] + spacing * c[1], origin[2] + spacing * c[2]};
  }
  Vec3 position(PointIndex p) const { return position(coordinates(p)); }
  /// The position of the last point, in the model's unit of length, as are all positions.
  Vec3 high() const {
    return position(GridCoordinates{counts[0] - 1, counts[1] - 1, counts[2] - 1});
  }
  double longest_side() const {
    const Vec3 top = high();
    return std::max({top[0] - origin[0], top[1] - origin[1], top[2] - origin[2]});
  }

  friend bool operator==(const Box&, const Box&) = default;
};

/// The steps of the 26 directions inside one box.
class Neighbourhood {
 public:
  explicit Neighbourhood(const Box& box);

  /// target - source as a difference of point indices.
  std::int64_t offset(int q) const { return offset_[q]; }
  /// The largest |offset| of any direction.
  std::int64_t reach() const { return reach_; }
  /// The shift d of the HIP, in the model's unit of length.
  const Vec3& shift(int q) const { return shift_[q]; }
  /// The directions that stay inside the box from `p`.
  DirectionMask inside(const GridCoordinates& c) const;
  DirectionMask inside(PointIndex p) const { return inside(box_.coordinates(p)); }

 private:
  Box box_;
  std::array<std::int64_t, kDirections> offset_;
  std::array<Vec3, kDirections> shift_;
  std::int64_t reach_ = 0;
};

}  // namespace hapgrid
