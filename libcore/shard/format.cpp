#include "libcore/shard/format.hpp"

#include <algorithm>
#include <bit>

namespace hapgrid {

namespace {
constexpr std::uint64_t kCodedChunkBytes = 1 << 20;
// Requests and frontiers stay small enough for the caches; smaller ones would be larger altogether.
constexpr std::uint64_t kRowsChunkBytes = 1 << 18;
// A round takes apart the chunks of the grid that it touches: the smaller they are, the less of
// them it does not change. Below this size they would get larger altogether.
constexpr std::uint64_t kGridChunkBytes = 1 << 16;

/// The power of two of points that fit at one level a point, at least 1.
std::uint32_t points_within(std::uint64_t bytes, std::uint32_t row_size) {
  const std::uint64_t fit = bytes / record_bytes(row_size);
  return static_cast<std::uint32_t>(std::bit_floor(std::max<std::uint64_t>(fit, 1)));
}
}  // namespace

const char* to_string(Content content) {
  switch (content) {
    case Content::kGrid:
      return "grid";
    case Content::kFrontier:
      return "frontier";
    case Content::kRequests:
      return "requests";
  }
  return "unknown";
}

std::uint32_t row_size(const SectionHeader& header) {
  return header.content == Content::kFrontier ? header.spec.state_size : header.spec.row_size();
}

std::uint64_t record_bytes(std::uint32_t row_size) {
  return sizeof(PointIndex) + sizeof(Level) + sizeof(std::uint32_t) +
         sizeof(double) * std::uint64_t{row_size} + kDirections;
}

std::uint32_t chunk_points(std::uint32_t row_size) {
  return points_within(kGridChunkBytes, row_size);
}

std::uint32_t coded_chunk_points(std::uint32_t row_size) {
  // The rows at the beginning of a chunk have little to be predicted from, so longer chunks are
  // smaller: on the reference field of tests/bench/codec.cpp by a tenth.
  return 4 * points_within(kCodedChunkBytes, row_size);
}

std::uint32_t chunk_rows(std::uint32_t row_size) {
  const std::uint64_t row = sizeof(PointIndex) + 2 + sizeof(double) * std::uint64_t{row_size};
  return static_cast<std::uint32_t>(std::max<std::uint64_t>(kRowsChunkBytes / row, 1));
}

}  // namespace hapgrid
