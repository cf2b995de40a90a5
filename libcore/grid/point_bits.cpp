#include "libcore/grid/point_bits.hpp"

#include <algorithm>

namespace hapgrid {

namespace {

/// Adds the points that are `by` points behind or before those of the set.
PointBits spread(const PointBits& bits, std::uint64_t by) {
  PointBits wide = bits;
  const std::size_t words = by / 64;
  const unsigned shift = by % 64;
  const auto at = [&](std::size_t i) { return i < bits.size() ? bits[i] : 0; };
  for (std::size_t i = 0; i < bits.size(); ++i) {
    // The word that stands `by` bits before this one, and the one that stands as far behind.
    const std::uint64_t low = i >= words ? bits[i - words] : 0;
    const std::uint64_t lower = i > words ? bits[i - words - 1] : 0;
    const std::uint64_t high = at(i + words), higher = at(i + words + 1);
    wide[i] |= shift == 0
                   ? low | high
                   : low << shift | lower >> (64 - shift) | high >> shift | higher << (64 - shift);
  }
  return wide;
}

}  // namespace

PointBits grown(PointBits bits, const Box& box) {
  const std::uint64_t points = box.points();
  bits = spread(bits, 1);
  bits = spread(bits, box.counts[0]);
  bits = spread(bits, std::uint64_t{box.counts[0]} * box.counts[1]);
  if (points % 64 != 0) bits.back() &= (std::uint64_t{1} << points % 64) - 1;
  return bits;
}

bool is_parallel(const Grid& grid, PointIndex p) {
  const RecordIndex first = grid.first(p), levels = grid.levels(p);
  for (RecordIndex l = 0; l < levels; ++l)
    if (!grid.links_lead_to(first + l, static_cast<Level>(l))) return false;
  return true;
}

PointBits tangled_points(const Grid& grid, int threads) {
  const std::uint64_t points = grid.box().points();
  PointBits bits((points + 63) / 64);
  constexpr std::uint64_t kWords = 256;
  const std::size_t blocks = (bits.size() + kWords - 1) / kWords;
  for_each_in_threads(blocks, threads, [&](std::size_t b) {
    for (std::uint64_t w = b * kWords; w < std::min<std::uint64_t>(bits.size(), (b + 1) * kWords);
         ++w) {
      const std::uint64_t begin = w * 64;
      if (grid.is_single(w)) {
        bits[w] = grid.lead_elsewhere(grid.first(static_cast<PointIndex>(begin)));
      } else {
        for (std::uint64_t p = begin; p < std::min(points, begin + 64); ++p)
          bits[w] |= std::uint64_t{!is_parallel(grid, static_cast<PointIndex>(p))} << (p - begin);
      }
    }
  });
  return grown(std::move(bits), grid.box());
}

}  // namespace hapgrid
