#include "libcore/shard/reader.hpp"

#include <bit>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/frame.hpp"
#include "libcore/shard/coded_message.hpp"
#include "libcore/shard/coding.hpp"
#include "libcore/shard/frame_reader.hpp"
#include "libcore/shard/schema.hpp"

namespace hapgrid {

namespace {

/// The largest message that a section can hold: a chunk near 256 KiB, in older shards 1 MiB,
/// or a single large row, or the requests of a record; a coded one is near 4 MiB, or four large
/// rows.
std::uint64_t chunk_limit(const SectionHeader& header) {
  const std::uint64_t rows = header.content == Content::kRequests ? kDirections + 4 : 4;
  const std::uint64_t factor = header.coding.is_coded ? 2 : 1;
  return factor * ((4 << 20) + rows * record_bytes(row_size(header)));
}

/// A column of `count` primitive values. A hostile list may have been encoded with another element
/// size.
template <class T, class List>
std::span<const T> column(List list, std::size_t count, const char* name) {
  constexpr auto kSize =
      sizeof(T) == 8 ? capnp::ElementSize::EIGHT_BYTES : capnp::ElementSize::FOUR_BYTES;
  const capnp::AnyList::Reader any(list);
  if (any.size() != count || (count > 0 && any.getElementSize() != kSize))
    throw FormatError(std::string("column ") + name + " does not fit the chunk");
  return {reinterpret_cast<const T*>(any.getRawBytes().begin()), count};
}

std::span<const std::uint8_t> column(capnp::Data::Reader data, std::size_t bytes,
                                     const char* name) {
  if (data.size() != bytes)
    throw FormatError(std::string("column ") + name + " does not fit the chunk");
  return {data.begin(), bytes};
}

/// Puts components that stand one after the other into the numbers [first, last) of each row.
template <class T>
void place(std::span<const T> components, std::size_t rows, std::uint32_t first, std::uint32_t last,
           std::size_t width, double* numbers) {
  for (std::uint32_t c = first; c < last; ++c)
    for (std::size_t r = 0; r < rows; ++r)
      numbers[r * width + c] = components[(c - first) * rows + r];
}

/// The rows of a chunk of `rows` rows: the state and what is stored with it.
template <class ChunkReader>
void read_rows(ChunkReader in, std::size_t rows, const SectionHeader& header, Chunk& chunk) {
  const GridSpec& spec = header.spec;
  const std::uint32_t n = spec.state_size;
  const bool frontier = header.content == Content::kFrontier;
  const auto size = [&](bool stored, std::size_t width) {
    return stored && !frontier ? rows * width : 0;
  };
  const std::size_t shape_width = spec.row_size() - spec.shape_offset();
  const auto state = column<double>(in.getState(), rows * n, "state");
  const auto force = column<double>(in.getForce(), size(spec.stored.force, 3), "force");
  const auto energy = column<double>(in.getEnergy(), size(spec.stored.energy, 1), "energy");
  const auto shape = column<float>(in.getShape(), size(spec.stored.shape, shape_width), "shape");
  chunk.width = row_size(header);
  if (chunk.width == 1) {
    chunk.numbers = state;
    return;
  }
  chunk.transposed.resize(rows * chunk.width);
  double* const numbers = chunk.transposed.data();
  place(state, rows, 0, n, chunk.width, numbers);
  if (!force.empty())
    place(force, rows, spec.force_offset(), spec.force_offset() + 3, chunk.width, numbers);
  if (!energy.empty())
    place(energy, rows, spec.energy_offset(), spec.energy_offset() + 1, chunk.width, numbers);
  if (!shape.empty())
    place(shape, rows, spec.shape_offset(), spec.row_size(), chunk.width, numbers);
  chunk.numbers = chunk.transposed;
}

}  // namespace

class SectionReader::State {
 public:
  explicit State(const Section& section)
      : section_(&section),
        neighbourhood_(section.header.spec.box),
        points_(section.header.spec.box.points()),
        frames_(*section.file, section.begin, section.end),
        coded_(section.header) {}

  const ChunkInfo* peek() const {
    const std::vector<ChunkInfo>& chunks = section_->footer.chunks;
    return next_ < chunks.size() ? &chunks[next_] : nullptr;
  }

  template <class Rows>
  bool next(Rows& rows) {
    const ChunkInfo* info = peek();
    if (!info) {
      finish();
      return false;
    }
    where_ = at(*section_->file, frames_.offset());
    decode_frame(next_frame(*info), *info, rows);
    count(*info);
    if (!info->counts_conversions()) conversions_sum_ += conversions_;
    return true;
  }

  void next_stored(StoredChunk& chunk) {
    chunk.info = *peek();
    where_ = at(*section_->file, frames_.offset());
    const std::span<const std::byte> frame = next_frame(chunk.info);
    if (any_ && chunk.info.first_point < key_point(last_))
      throw FormatError(where_ + ": damaged: chunks out of order");
    chunk.frame.assign(frame.begin(), frame.end());
    count_undecoded(chunk.info);
    any_ = true;
    last_ = record_key(chunk.info.last_point, 0);
  }

  void pass_over() {
    frames_.next(limit());
    count_undecoded(*peek());
  }

  void decode_stored(const StoredChunk& chunk, RecordRows& rows) {
    const bool any = std::exchange(any_, false);
    const RowKey last = last_;
    where_ =
        section_->file->name() + ": chunk from point " + std::to_string(chunk.info.first_point);
    decode_frame(chunk.frame, chunk.info, rows);
    any_ = any;
    last_ = last;
  }

 private:
  const GridSpec& spec() const { return section_->header.spec; }
  std::uint64_t limit() const { return chunk_limit(section_->header); }

  std::span<const std::byte> next_frame(const ChunkInfo& info) {
    const std::span<const std::byte> frame = frames_.next(limit());
    if (hash_of(frame) != info.stored)
      throw FormatError(where_ + ": damaged: a chunk does not fit the footer's hash of it");
    return frame;
  }

  template <class Rows>
  void decode_frame(std::span<const std::byte> frame, const ChunkInfo& info, Rows& rows) {
    try {
      decoder_.decode(frame, limit(), rows.message);
    } catch (const FormatError& e) {
      throw FormatError(where_ + ": " + e.what());
    }
    if (digest_of(std::as_bytes(std::span(rows.message))) != info.digest)
      throw FormatError(where_ + ": damaged: a chunk does not fit the footer's digest of it");
    read_message(rows.message, where_, [&](schema::Message::Reader message) {
      frontier_ = 0;
      conversions_ = 0;
      read(message, rows);
      if (rows.size() != info.rows || key_point(last_) != info.last_point ||
          rows.point[0] != info.first_point || frontier_ != info.frontier ||
          (info.counts_conversions() && conversions_ != info.conversions))
        throw FormatError("damaged: a chunk does not fit what the footer says of it");
    });
  }

  void count(const ChunkInfo& info) {
    ++next_;
    rows_ += info.rows;
    frontier_sum_ += info.frontier;
    conversions_sum_ += info.conversions;
  }

  void count_undecoded(const ChunkInfo& info) {
    count(info);
    if (!info.counts_conversions()) uncounted_ = true;
  }

  /// Compares the footer's sums with what was read.
  void finish() const {
    const SectionFooter& footer = section_->footer;
    const bool requests = section_->header.content == Content::kRequests;
    if (footer.records != (requests ? 0 : rows_) || footer.requests != requests_ ||
        footer.frontier != frontier_sum_ || (!uncounted_ && footer.conversions != conversions_sum_))
      throw FormatError(section_->file->name() +
                        ": damaged: the counts in the footer do not fit the content");
  }

  void read(schema::Message::Reader message, RecordRows& rows) {
    if (section_->header.coding.is_coded) {
      if (!message.isCoded()) throw FormatError("damaged: a coded chunk was expected");
      coded_.decode(decode_coded(message.getCoded()), rows);
    } else {
      read_columns(message, rows);
    }
    check_rows(rows);
  }

  void read_columns(schema::Message::Reader message, RecordRows& rows) {
    if (!message.isRecords()) throw FormatError("damaged: a chunk of records was expected");
    const schema::RecordChunk::Reader chunk = message.getRecords();
    const std::size_t count = chunk.getPoint().size();
    const bool grid = section_->header.content == Content::kGrid;
    if (count == 0) throw FormatError("damaged: a chunk without rows");
    rows.point = column<PointIndex>(chunk.getPoint(), count, "point");
    rows.level = column(chunk.getLevel(), count, "level");
    rows.generation = column<std::uint32_t>(chunk.getGeneration(), count, "generation");
    read_rows(chunk, count, section_->header, rows);
    rows.links = column(chunk.getLinks(), grid ? count * kDirections : 0, "links");
    rows.todo = column<DirectionMask>(chunk.getTodo(), grid ? 0 : count, "todo");
  }

  void check_rows(const RecordRows& rows) {
    const bool grid = section_->header.content == Content::kGrid;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const PointIndex p = rows.point[r];
      check_row(p, record_key(p, rows.level[r]), rows.level[r]);
      const bool in_frontier = rows.generation[r] == section_->header.generation;
      if (rows.generation[r] > section_->header.generation || (!grid && !in_frontier))
        throw FormatError("damaged: a record of generation " + std::to_string(rows.generation[r]));
      if (!in_frontier) continue;
      const DirectionMask inside = neighbourhood_.inside(p);
      if (!grid && (rows.todo[r] & ~inside))
        throw FormatError("damaged: a direction to be expanded leaves the box");
      conversions_ += static_cast<std::uint32_t>(std::popcount(grid ? inside : rows.todo[r]));
      ++frontier_;
    }
  }

  void read(schema::Message::Reader message, RequestRows& rows) {
    if (!message.isReached()) throw FormatError("damaged: a chunk of requests was expected");
    const schema::ReachedChunk::Reader chunk = message.getReached();
    const std::size_t count = chunk.getPoint().size();
    if (count == 0) throw FormatError("damaged: a chunk without rows");
    rows.point = column<PointIndex>(chunk.getPoint(), count, "point");
    rows.level = column(chunk.getLevel(), count, "level");
    rows.directions = column<DirectionMask>(chunk.getDirections(), count, "directions");
    rows.first.resize(count);
    std::size_t requests = 0;
    for (std::size_t r = 0; r < count; ++r) {
      const PointIndex p = rows.point[r];
      check_row(p, record_key(p, rows.level[r]), rows.level[r]);
      const DirectionMask directions = rows.directions[r];
      if (directions == 0) throw FormatError("damaged: a record without requests");
      if (directions & ~neighbourhood_.inside(p))
        throw FormatError("damaged: a request that leaves the box");
      rows.first[r] = static_cast<std::uint32_t>(requests);
      requests += static_cast<std::size_t>(std::popcount(directions));
    }
    read_rows(chunk, requests, section_->header, rows);
    for (const double number : rows.numbers)
      if (!std::isfinite(number)) throw FormatError("damaged: a request's state is not finite");
    requests_ += requests;
  }

  void check_row(PointIndex point, RowKey key, Level level) {
    if (point >= points_)
      throw FormatError("damaged: point " + std::to_string(point) + " is outside the box");
    if (level >= spec().max_levels)
      throw FormatError("damaged: level " + std::to_string(level) + " at point " +
                        std::to_string(point) + ", the limit is " +
                        std::to_string(spec().max_levels));
    if (any_ && key <= last_)
      throw FormatError("damaged: rows out of order at point " + std::to_string(point));
    any_ = true;
    last_ = key;
  }

  const Section* section_;
  Neighbourhood neighbourhood_;
  std::uint64_t points_;
  FrameReader frames_;
  FrameDecoder decoder_{"shard", /*hashed=*/true};
  ChunkDecoder coded_;
  std::string where_;       // the chunk at hand, for messages
  std::size_t next_ = 0;    // chunk
  std::uint64_t rows_ = 0;  // of the chunks before it
  std::uint64_t frontier_sum_ = 0;
  std::uint64_t conversions_sum_ = 0;
  bool uncounted_ = false;  // a chunk before it was not decoded, and does not say its conversions
  std::uint64_t requests_ = 0;
  std::uint32_t frontier_ = 0;  // of the chunk at hand, as the next one
  std::uint32_t conversions_ = 0;
  bool any_ = false;
  RowKey last_ = 0;
};

SectionReader::SectionReader(const Section& section) : state_(std::make_unique<State>(section)) {}
SectionReader::~SectionReader() = default;
SectionReader::SectionReader(SectionReader&&) noexcept = default;

bool SectionReader::next(RecordRows& rows) { return state_->next(rows); }
bool SectionReader::next(RequestRows& rows) { return state_->next(rows); }
const ChunkInfo* SectionReader::peek() const { return state_->peek(); }
void SectionReader::next_stored(StoredChunk& chunk) { state_->next_stored(chunk); }
void SectionReader::pass_over() { state_->pass_over(); }
void SectionReader::decode(const StoredChunk& chunk, RecordRows& rows) {
  state_->decode_stored(chunk, rows);
}

}  // namespace hapgrid
