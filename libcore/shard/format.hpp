// The messages of a shard as C++ values: what schemas/shard.capnp says, in the shapes that the
// search works with. Only the sources of this folder see Cap'n Proto.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/digest.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/grid/spec.hpp"

namespace hapgrid {

enum class Content { kGrid, kFrontier, kRequests };

/// "grid", "frontier" or "requests".
const char* to_string(Content content);

/// How the chunks of a finished grid are made small (schemas/CODING.md).
struct Coding {
  bool is_coded = false;
  /// 0: nothing is lost. Else the share of its range by which each number may be off, and by how
  /// much that is: a bound for each number of a row, in its own unit; 0: not at all.
  double precision = 0;
  std::vector<double> bounds;

  bool is_lossy() const { return precision > 0; }
};

/// The largest precision: more would not leave much of the states.
inline constexpr double kMaxPrecision = 0.1;

struct SectionHeader {
  Content content = Content::kGrid;
  std::uint32_t generation = 0;  ///< the youngest generation; of requests: their source records'
  GridSpec spec;
  Coding coding{};  ///< of grids
};

/// What the footer says of one chunk.
struct ChunkInfo {
  std::uint32_t rows = 0;
  std::uint32_t frontier = 0;
  PointIndex first_point = 0;
  PointIndex last_point = 0;
  Digest digest;                  ///< of the message
  std::uint64_t stored = 0;       ///< hash of the frame
  std::uint32_t conversions = 0;  ///< that its frontier asks for

  /// Shards of before `conversions` was counted have 0 there.
  bool counts_conversions() const { return frontier == 0 || conversions > 0; }
};

struct SectionFooter {
  std::vector<ChunkInfo> chunks;
  std::uint64_t records = 0;
  std::uint64_t requests = 0;
  std::uint64_t frontier = 0;
  std::uint64_t conversions = 0;
  Digest digest;

  PointIndex first_point() const { return chunks.empty() ? 0 : chunks.front().first_point; }
};

/// One chunk as it is stored.
struct StoredChunk {
  ChunkInfo info;
  std::vector<std::byte> frame;
};

/// One chunk of a section, decoded. The columns look into the message.
struct Chunk {
  std::vector<std::uint64_t> message;
  std::vector<double> transposed;   ///< the rows, where they have more than one number
  std::size_t width = 0;            ///< numbers a row: row_size() of the section's header
  std::span<const double> numbers;  ///< R x width; each row begins with the state

  const double* row(std::size_t r) const { return &numbers[r * width]; }
};

/// R records. A grid's have links (R x 26) and no todo, a frontier's have todo and no links.
struct RecordRows : Chunk {
  std::vector<PointIndex> coded_point;  ///< what the columns look into where the chunk was coded
  std::vector<std::uint32_t> coded_generation;
  std::span<const PointIndex> point;
  std::span<const Level> level;
  std::span<const std::uint32_t> generation;
  std::span<const Level> links;
  std::span<const DirectionMask> todo;

  std::size_t size() const { return point.size(); }
};

/// What N requests of R source records reached. The numbers are N x width: those of a record's
/// `directions`, ascending.
struct RequestRows : Chunk {
  std::span<const PointIndex> point;
  std::span<const Level> level;
  std::span<const DirectionMask> directions;
  std::vector<std::uint32_t> first;  ///< R: each record's first request

  std::size_t size() const { return point.size(); }
};

/// Where a row stands in its section's order: by (point, level).
using RowKey = std::uint64_t;
inline RowKey record_key(PointIndex point, Level level) { return RowKey{point} << 8 | level; }
inline PointIndex key_point(RowKey key) { return static_cast<PointIndex>(key >> 8); }

/// How many numbers a row of the section has: a frontier's are the states alone, which is all that
/// a conversion starts from.
std::uint32_t row_size(const SectionHeader& header);

/// Bytes of one record of a grid before compression, for rows of `row_size` numbers.
std::uint64_t record_bytes(std::uint32_t row_size);

/// How many points one chunk of a grid covers: the power of two that keeps a chunk at one level a
/// point at or below 64 KiB (at least 1).
std::uint32_t chunk_points(std::uint32_t row_size);

/// The same for a coded grid, where a chunk is near 4 MiB before it is coded; also the most rows
/// that such a chunk has.
std::uint32_t coded_chunk_points(std::uint32_t row_size);

/// How many requests, or records of a frontier, a chunk has at most; but a record's requests stay
/// together.
std::uint32_t chunk_rows(std::uint32_t row_size);

}  // namespace hapgrid
