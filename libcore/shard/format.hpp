// The messages of a shard as C++ values: what schemas/shard.capnp says, in the shapes that the
// search works with. Only the sources of this folder see Cap'n Proto.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/digest.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

enum class Content { kGrid, kRequests };

/// "grid" or "requests".
const char* to_string(Content content);

struct SectionHeader {
  Content content = Content::kGrid;
  std::uint32_t generation = 0;  ///< the youngest generation; of requests: their source records'
  GridSpec spec;
};

/// What the footer says of one chunk.
struct ChunkInfo {
  std::uint64_t offset = 0;  ///< where its zstd frame starts in the file; follows from the sizes
  std::uint32_t size = 0;    ///< of its zstd frame
  std::uint32_t rows = 0;
  std::uint32_t frontier = 0;     ///< records of the header's generation
  std::uint32_t conversions = 0;  ///< that its frontier asks for; of requests: how many
  PointIndex first_point = 0;
  PointIndex last_point = 0;
  Digest digest;  ///< of the message
};

/// The last bytes of a section, as they are in memory: they say where its footer is, so that a
/// reader of a file goes straight to it. A skippable zstd frame, which `zstd -d` passes over.
struct Locator {
  std::uint32_t magic = 0x184D2A5E;
  std::uint32_t size = sizeof(std::uint64_t);
  std::uint64_t footer = 0;  ///< bytes of its zstd frame, which ends where the locator starts

  bool is_valid() const { return magic == Locator{}.magic && size == Locator{}.size; }
};
static_assert(sizeof(Locator) == 16 && std::endian::native == std::endian::little);

/// The digest of a section, from that of its header's message and those of its chunks.
Digest section_digest(const Digest& header, std::span<const ChunkInfo> chunks);

/// One chunk of a section, decoded: records, or what the requests of source records reached. The
/// columns look into the message.
struct Chunk {
  MessageWords message;
  std::vector<double> transposed;  ///< the numbers, where a row has more than one
  std::size_t width = 0;           ///< numbers a row: the grid's row_size()
  /// Row after row, each of which begins with a state: one for each record; of requests, for each
  /// record one for each of its `directions`, ascending.
  std::span<const double> numbers;
  std::span<const PointIndex> point;
  std::span<const Level> level;
  // Of a grid:
  std::span<const std::uint32_t> generation;
  std::span<const Level> links;  ///< 26 for each record
  // Of requests:
  std::span<const DirectionMask> directions;
  std::vector<std::uint32_t> first;  ///< each record's first request

  /// Records.
  std::size_t size() const { return point.size(); }
  const double* row(std::size_t r) const { return &numbers[r * width]; }
  /// Of a grid.
  operator RecordRun() const { return {point, level, generation, numbers, links}; }
};

/// The rows of a section ascend by this key: (point, level).
using RowKey = std::uint64_t;
inline RowKey record_key(PointIndex point, Level level) { return RowKey{point} << 8 | level; }

/// Bytes of one record before compression, for rows of `row_size` numbers.
std::uint64_t record_bytes(std::uint32_t row_size);

/// Bytes of a grid's chunk before compression. A part of a round reads few chunks when they are
/// small; but with smaller ones than this the whole grid would be larger.
inline constexpr std::uint64_t kChunkBytes = 1 << 16;
/// The same of a finished grid that is stored small.
inline constexpr std::uint64_t kLargeChunkBytes = 1 << 20;

/// How many points one chunk of a grid covers: the power of two that keeps a chunk at one level a
/// point at or below `bytes` (at least 1). It has no more rows than this either.
std::uint32_t chunk_points(std::uint32_t row_size, std::uint64_t bytes = kChunkBytes);

/// How many requests a chunk has at most; a record's requests stay together.
std::uint32_t chunk_requests(std::uint32_t row_size);

}  // namespace hapgrid
