#include "libcore/shard/reader.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <exception>
#include <mutex>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/shard/schema.hpp"

namespace hapgrid {

namespace {

/// The largest message that a section can hold: a chunk near 1 MiB with columns that capnp padded,
/// or a single large row, or the requests of a record.
std::uint64_t chunk_limit(const SectionHeader& header) {
  const std::uint64_t rows = header.content == Content::kRequests ? kDirections + 4 : 4;
  return (4 << 20) + rows * record_bytes(header.spec.row_size());
}

/// Puts components that stand one after the other into the numbers [first, last) of each row.
template <class T>
void place(std::span<const T> components, std::size_t rows, std::uint32_t first, std::uint32_t last,
           std::size_t width, double* numbers) {
  for (std::uint32_t c = first; c < last; ++c)
    for (std::size_t r = 0; r < rows; ++r)
      numbers[r * width + c] = components[(c - first) * rows + r];
}

/// The numbers of a chunk's rows: the state and what is stored with it.
template <class ChunkReader>
void read_numbers(ChunkReader in, std::size_t rows, const GridSpec& spec, Chunk& chunk) {
  const std::uint32_t n = spec.state_size;
  const std::size_t shape_width = spec.row_size() - spec.shape_offset();
  const auto state = column<double>(in.getState(), rows * n, "state");
  const auto force = column<double>(in.getForce(), spec.stored.force ? 3 * rows : 0, "force");
  const auto energy = column<double>(in.getEnergy(), spec.stored.energy ? rows : 0, "energy");
  const auto shape = column<float>(in.getShape(), rows * shape_width, "shape");
  chunk.width = spec.row_size();
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

std::size_t count_directions(std::span<const DirectionMask> directions) {
  std::size_t count = 0;
  for (const DirectionMask mask : directions)
    count += static_cast<std::size_t>(std::popcount(mask));
  return count;
}

/// Reads the columns that chunks of both kinds have. Answers how many records there are.
template <class ChunkReader>
std::size_t read_keys(ChunkReader in, Chunk& chunk) {
  const std::size_t count = in.getPoint().size();
  if (count == 0) throw FormatError("damaged: a chunk without rows");
  chunk.point = column<PointIndex>(in.getPoint(), count, "point");
  chunk.level = column(in.getLevel(), count, "level");
  return count;
}

void read_records(schema::Message::Reader message, const GridSpec& spec, Chunk& chunk) {
  if (!message.isRecords()) throw FormatError("damaged: a chunk of records was expected");
  const schema::RecordChunk::Reader in = message.getRecords();
  const std::size_t count = read_keys(in, chunk);
  chunk.generation = column<std::uint32_t>(in.getGeneration(), count, "generation");
  chunk.links = column(in.getLinks(), count * kDirections, "links");
  read_numbers(in, count, spec, chunk);
}

void read_requests(schema::Message::Reader message, const GridSpec& spec, Chunk& chunk) {
  if (!message.isRequests()) throw FormatError("damaged: a chunk of requests was expected");
  const schema::RequestChunk::Reader in = message.getRequests();
  const std::size_t count = read_keys(in, chunk);
  chunk.directions = column<DirectionMask>(in.getDirections(), count, "directions");
  read_numbers(in, count_directions(chunk.directions), spec, chunk);
}

[[noreturn]] void fail_footer() {
  throw FormatError("damaged: a chunk does not fit what the footer says of it");
}

}  // namespace

SectionReader::SectionReader(const Section& section)
    : section_(&section), neighbourhood_(section.header.spec.box) {}

void SectionReader::read(std::size_t chunk, Chunk& rows) {
  const SectionHeader& header = section_->header;
  const bool is_grid = header.content == Content::kGrid;
  const ChunkInfo& info = section_->chunks[chunk];
  bytes_.resize(info.size);
  bytes_.resize(section_->file->read(info.offset, bytes_));
  try {
    decode_zstd_frame(bytes_, chunk_limit(header), "shard", rows.message);
    if (digest_of(std::as_bytes(std::span(rows.message))) != info.digest)
      throw FormatError("damaged: a chunk does not fit the footer's digest of it");
    read_message<schema::Message>(rows.message, [&](schema::Message::Reader message) {
      (is_grid ? read_records : read_requests)(message, header.spec, rows);
      check_order(rows);
      if (is_grid)
        check_records(info, rows);
      else
        check_requests(info, rows);
      if (rows.size() != info.rows || rows.point.front() != info.first_point ||
          rows.point.back() != info.last_point)
        fail_footer();
    });
  } catch (const FormatError& e) {
    throw FormatError(format("{}: {}", at(*section_->file, info.offset), e.what()));
  }
}

void SectionReader::check_order(const Chunk& rows) const {
  const GridSpec& spec = section_->header.spec;
  const std::uint64_t points = spec.box.points();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const PointIndex point = rows.point[r];
    if (point >= points) throw FormatError(format("damaged: point {} is outside the box", point));
    if (rows.level[r] >= spec.max_levels)
      throw FormatError(format("damaged: level {} at point {}, the limit is {}", rows.level[r],
                               point, spec.max_levels));
    if (r > 0 &&
        record_key(point, rows.level[r]) <= record_key(rows.point[r - 1], rows.level[r - 1]))
      throw FormatError(format("damaged: rows out of order at point {}", point));
  }
}

void SectionReader::check_records(const ChunkInfo& info, const Chunk& rows) const {
  std::uint32_t frontier = 0, conversions = 0;
  // Where nothing is wrong this loop decides nothing, and the compiler makes it fast.
  std::uint32_t youngest = 0;
  for (const std::uint32_t generation : rows.generation) youngest = std::max(youngest, generation);
  for (std::size_t r = 0; r < rows.size() && youngest >= section_->header.generation; ++r) {
    if (rows.generation[r] > section_->header.generation)
      throw FormatError(format("damaged: a record of generation {}", rows.generation[r]));
    if (rows.generation[r] != section_->header.generation) continue;
    ++frontier;
    conversions += static_cast<std::uint32_t>(std::popcount(neighbourhood_.inside(rows.point[r])));
  }
  if (frontier != info.frontier || conversions != info.conversions) fail_footer();
}

void SectionReader::check_requests(const ChunkInfo& info, Chunk& rows) const {
  std::uint32_t conversions = 0;
  rows.first.resize(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const DirectionMask directions = rows.directions[r];
    if (directions == 0) throw FormatError("damaged: a record without requests");
    if (directions & ~neighbourhood_.inside(rows.point[r]))
      throw FormatError("damaged: a request that leaves the box");
    rows.first[r] = conversions;
    conversions += static_cast<std::uint32_t>(std::popcount(directions));
  }
  for (const double number : rows.numbers)
    if (!std::isfinite(number)) throw FormatError("damaged: a request's state is not finite");
  if (info.frontier != 0 || conversions != info.conversions) fail_footer();
}

namespace {

// zstd makes at most some thousand bytes out of one.
constexpr std::uint64_t kMaxRatio = 4096;

/// Calls use(first, rows) for each chunk of a grid's section, where `first` is the number of its
/// first record in the section; from several threads and in no particular order.
/// @throw what reading or `use` throws, of the first chunk for which either does: so the same
/// damage gives the same message, whatever the threads.
template <class Use>
void for_each_chunk(const Section& section, const Use& use) {
  const std::vector<ChunkInfo>& chunks = section.chunks;
  std::vector<std::uint64_t> first(chunks.size());
  for (std::size_t i = 1; i < chunks.size(); ++i) first[i] = first[i - 1] + chunks[i - 1].rows;
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::size_t failed = chunks.size();
  std::exception_ptr failure;
  const auto work = [&](std::size_t) {
    SectionReader reader(section);
    Chunk rows;
    for (std::size_t i; (i = next++) < chunks.size();) try {
        reader.read(i, rows);
        use(first[i], rows);
      } catch (...) {
        const std::lock_guard lock(mutex);
        next = chunks.size();  // all before this one are being read, or were
        if (i < failed) {
          failed = i;
          failure = std::current_exception();
        }
      }
  };
  const auto useful = std::min(static_cast<std::size_t>(all_threads()), chunks.size());
  for_each_in_threads(useful, static_cast<int>(useful), work);
  if (failure) std::rethrow_exception(failure);
}

/// The footer says how much memory the grid takes. Where that is out of proportion to the size of
/// the section, this reads all chunks first, because a hostile footer can claim anything.
/// @throw FormatError
void require_plausible(const Section& section) {
  const std::uint64_t bytes = record_bytes(section.header.spec.row_size());
  if (section.records() > kMaxRatio * section.size() / bytes)
    for_each_chunk(section, [](std::uint64_t, const Chunk&) {});
}

}  // namespace

Grid load_grid(const std::string& name) { return load_grid(open_grid(name)); }

Grid load_grid(const Section& section) {
  require_plausible(section);
  GridBuilder grid(section.header.spec, section.header.generation, section.records());
  std::mutex mutex;  // to add a chunk takes a small part of the time in which it is read
  for_each_chunk(section, [&](std::uint64_t first, const Chunk& rows) {
    const std::lock_guard lock(mutex);
    grid.add(first, rows);
  });
  return grid.finish();
}

}  // namespace hapgrid
