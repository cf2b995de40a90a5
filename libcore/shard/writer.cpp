#include "libcore/shard/writer.hpp"

#include <capnp/message.h>
#include <capnp/serialize.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <type_traits>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/frame.hpp"
#include "libcore/shard/coded_message.hpp"
#include "libcore/shard/coding.hpp"
#include "libcore/shard/schema.hpp"
#include "libcore/shard/section_digest.hpp"

namespace hapgrid {

static_assert(std::endian::native == std::endian::little,
              "columns are copied as they are in memory, and Cap'n Proto is little-endian");

namespace {

/// How chunks are compressed. In most, speed counts, and links and smooth states compress nearly as
/// well at level 1 as at level 3; above all in requests and frontiers, which are written and read
/// once. Layers of a grid are not among these: a chunk of them can be copied into the grid as it is
/// stored, whose bytes must not tell. A coded grid is written once and kept.
FrameEncoder frame_encoder(const SectionHeader& header) {
  if (header.coding.is_coded) return FrameEncoder(3);
  using Literals = FrameEncoder::Literals;
  return FrameEncoder(1, header.content == Content::kGrid ? Literals::kCoded : Literals::kPlain);
}

template <class List, class T>
void copy_column(List list, const std::unique_ptr<T[]>& column) {
  const auto bytes = capnp::AnyList::Reader(list.asReader()).getRawBytes();
  std::memcpy(const_cast<kj::byte*>(bytes.begin()), column.get(), list.size() * sizeof(T));
}

/// The numbers [first, last) of each row, component by component. `numbers` is row-major.
template <class T>
void copy_components(typename capnp::List<T>::Builder list, const double* numbers,
                     std::size_t width, std::uint32_t first, std::uint32_t last) {
  const auto bytes = capnp::AnyList::Reader(list.asReader()).getRawBytes();
  auto* out = reinterpret_cast<T*>(const_cast<kj::byte*>(bytes.begin()));
  const std::size_t rows = list.size() / (last - first);
  if constexpr (std::is_same_v<T, double>) {
    if (width == 1) {
      std::memcpy(out, numbers, rows * sizeof(double));
      return;
    }
  }
  for (std::size_t r = 0; r < rows; ++r)
    for (std::uint32_t c = first; c < last; ++c)
      out[(c - first) * rows + r] = static_cast<T>(numbers[r * width + c]);
}

/// The numbers of the rows into the columns that they belong to.
template <class ChunkBuilder>
void copy_rows(ChunkBuilder chunk, unsigned rows, const double* numbers, std::size_t width,
               const GridSpec& spec) {
  const std::uint32_t n = spec.state_size;
  copy_components<double>(chunk.initState(rows * n), numbers, width, 0, n);
  if (width == n) return;
  if (spec.stored.force)
    copy_components<double>(chunk.initForce(rows * 3), numbers, width, spec.force_offset(),
                            spec.force_offset() + 3);
  if (spec.stored.energy)
    copy_components<double>(chunk.initEnergy(rows), numbers, width, spec.energy_offset(),
                            spec.energy_offset() + 1);
  if (spec.stored.shape)
    copy_components<float>(chunk.initShape(rows * (spec.row_size() - spec.shape_offset())), numbers,
                           width, spec.shape_offset(), spec.row_size());
}

kj::ArrayPtr<const kj::byte> bytes_of(const std::unique_ptr<std::uint8_t[]>& column,
                                      std::size_t size) {
  return kj::arrayPtr(column.get(), size);
}

}  // namespace

/// Messages to digest, frames and the file.
class SectionWriter::Encoder {
 public:
  Encoder(int fd, std::string name, FrameEncoder frames)
      : fd_(fd), name_(std::move(name)), frames_(std::move(frames)) {}

  /// Builds one message with `fill(schema::Message::Builder)`, which needs at most `words`, and
  /// writes it. Sets the digests of `info` where it is not null.
  template <class F>
  void write(std::size_t words, ChunkInfo* info, F&& fill) {
    // The message is built one word behind the start of the buffer: its segment table goes in
    // front, so that no copy is needed. Cap'n Proto clears the segment again when it is done.
    reserve(words + kSpareWords);
    auto* first = reinterpret_cast<capnp::word*>(scratch_.get() + 1);
    capnp::MallocMessageBuilder builder(kj::arrayPtr(first, scratch_words_ - 1));
    fill(builder.initRoot<schema::Message>());
    const auto segments = builder.getSegmentsForOutput();
    if (segments.size() == 1) {
      const auto size = static_cast<std::uint32_t>(segments[0].size());
      const std::uint32_t table[2] = {0, size};
      std::memcpy(scratch_.get(), table, sizeof table);
      encode(std::as_bytes(std::span(scratch_.get(), size + 1)), info);
    } else {
      const auto flat = capnp::messageToFlatArray(segments);
      const auto bytes = flat.asBytes();
      encode(std::as_bytes(std::span(bytes.begin(), bytes.size())), info);
    }
  }

  void copy(const StoredChunk& chunk) {
    digester_->add(chunk.info.digest);
    write(chunk.frame);
  }

  /// Everything that was encoded or copied is in the file.
  void drain() {
    write_all(fd_, pending_, name_);
    pending_.clear();
  }

  Digest digest() const { return digester_->digest(); }

 private:
  static constexpr std::size_t kSpareWords = 256;
  static constexpr std::size_t kWriteBytes = 128 << 10;

  /// Cap'n Proto wants its memory cleared; calloc's pages are, and cost nothing until used.
  void reserve(std::size_t words) {
    if (scratch_words_ >= words) return;
    scratch_.reset(static_cast<std::uint64_t*>(std::calloc(words, sizeof(std::uint64_t))));
    if (!scratch_) throw std::bad_alloc();
    scratch_words_ = words;
  }

  void encode(std::span<const std::byte> message, ChunkInfo* info) {
    const std::span<const std::byte> frame = frames_.encode(message);
    if (info) {
      info->digest = digest_of(message);
      info->stored = hash_of(frame);
      digester_->add(info->digest);
    } else if (!digester_) {  // the first message is the header
      digester_.emplace(message);
    }
    write(frame);
  }

  /// Frames of a grid are a few KiB each, and a call of the system for each would cost more than to
  /// copy them.
  void write(std::span<const std::byte> frame) {
    pending_.insert(pending_.end(), frame.begin(), frame.end());
    if (pending_.size() >= kWriteBytes) drain();
  }

  int fd_;
  std::string name_;
  FrameEncoder frames_;
  std::vector<std::byte> pending_;  // frames that are not written yet
  std::optional<SectionDigester> digester_;
  struct Free {
    void operator()(void* memory) const { std::free(memory); }
  };
  std::unique_ptr<std::uint64_t[], Free> scratch_;
  std::size_t scratch_words_ = 0;
};

SectionWriter::SectionWriter(int fd, const std::string& name, const SectionHeader& header, Cut cut)
    : header_(header),
      row_size_(row_size(header)),
      neighbourhood_(header.spec.box),
      encoder_(std::make_unique<Encoder>(fd, name, frame_encoder(header))),
      cut_(cut),
      row_limit_(header.content == Content::kRequests
                     ? std::max<std::uint32_t>(chunk_rows(row_size_), kDirections)
                 : header.content == Content::kFrontier ? chunk_rows(row_size_)
                 : header.coding.is_coded               ? coded_chunk_points(row_size_)
                                                        : chunk_points(row_size_)) {
  if (header.coding.is_coded) coder_ = std::make_unique<ChunkEncoder>(header_);
  const std::size_t rows = row_limit_;
  columns_.point = std::make_unique_for_overwrite<PointIndex[]>(rows);
  columns_.level = std::make_unique_for_overwrite<Level[]>(rows);
  columns_.numbers = std::make_unique_for_overwrite<double[]>(rows * row_size_);
  if (header.content != Content::kRequests)
    columns_.generation = std::make_unique_for_overwrite<std::uint32_t[]>(rows);
  if (header.content == Content::kGrid)
    columns_.links = std::make_unique_for_overwrite<Level[]>(rows * kDirections);
  else
    columns_.directions = std::make_unique_for_overwrite<DirectionMask[]>(rows);
  // A guess: what does not fit is put together from more segments.
  encoder_->write(1024, nullptr, [&](schema::Message::Builder message) {
    encode_header(header, message.initHeader());
  });
}
SectionWriter::~SectionWriter() = default;
SectionWriter::SectionWriter(SectionWriter&&) noexcept = default;

void SectionWriter::record(PointIndex point, Level level, std::uint32_t generation,
                           const double* row_numbers, const Level* links) {
  enter_range(point);
  const std::size_t row = add_row(point, level, row_numbers);
  ++footer_.records;
  count_frontier(point, generation);
  columns_.generation[row] = generation;
  std::memcpy(&columns_.links[row * kDirections], links, kDirections);
}

void SectionWriter::records(const RecordRows& rows, std::size_t begin, std::size_t end) {
  const auto copy = [&](const auto& from, auto* to, std::size_t each, std::size_t count) {
    std::memcpy(to + rows_ * each, from.data() + begin * each, count * each * sizeof *to);
  };
  while (begin < end) {
    enter_range(rows.point[begin]);
    if (rows_ == row_limit_) flush();
    std::size_t stop = std::min(end, begin + row_limit_ - rows_);
    while (rows.point[stop - 1] >= range_end_) --stop;
    copy(rows.point, columns_.point.get(), 1, stop - begin);
    copy(rows.level, columns_.level.get(), 1, stop - begin);
    copy(rows.generation, columns_.generation.get(), 1, stop - begin);
    copy(rows.numbers, columns_.numbers.get(), row_size_, stop - begin);
    copy(rows.links, columns_.links.get(), kDirections, stop - begin);
    for (std::size_t r = begin; r < stop; ++r) count_frontier(rows.point[r], rows.generation[r]);
    rows_ += stop - begin;
    footer_.records += stop - begin;
    begin = stop;
  }
}

void SectionWriter::enter_range(PointIndex point) {
  if (point < range_end_) return;
  flush();
  range_end_ = cut_ == Cut::kByRows ? ~std::uint64_t{0}
                                    : (std::uint64_t{point} / row_limit_ + 1) * row_limit_;
}

void SectionWriter::count_frontier(PointIndex point, std::uint32_t generation) {
  if (generation != header_.generation) return;
  ++frontier_;
  conversions_ += static_cast<std::uint32_t>(std::popcount(neighbourhood_.inside(point)));
}

void SectionWriter::frontier(PointIndex point, Level level, const double* state,
                             DirectionMask todo) {
  const std::size_t row = add_row(point, level, state);
  ++footer_.records;
  ++frontier_;
  conversions_ += static_cast<std::uint32_t>(std::popcount(todo));
  columns_.generation[row] = header_.generation;
  columns_.directions[row] = todo;
}

void SectionWriter::requests(PointIndex point, Level level, DirectionMask directions,
                             const double* rows) {
  const auto count = static_cast<std::size_t>(std::popcount(directions));
  if (requests_ + count > row_limit_) flush();
  columns_.point[rows_] = point;
  columns_.level[rows_] = level;
  columns_.directions[rows_] = directions;
  ++rows_;
  double* to = &columns_.numbers[requests_ * row_size_];
  if (directions == kAllDirections) {
    std::copy_n(rows, count * row_size_, to);
  } else {
    for (DirectionMask left = directions; left; left &= left - 1, to += row_size_)
      std::copy_n(rows + static_cast<std::size_t>(std::countr_zero(left)) * row_size_, row_size_,
                  to);
  }
  requests_ += count;
  footer_.requests += count;
}

void SectionWriter::copy(const StoredChunk& chunk) {
  flush();
  footer_.records += chunk.info.rows;
  footer_.chunks.push_back(chunk.info);
  encoder_->copy(chunk);
}

RecordRows SectionWriter::rows_so_far() const {
  RecordRows rows;
  rows.width = row_size_;
  rows.numbers = {columns_.numbers.get(), rows_ * row_size_};
  rows.point = {columns_.point.get(), rows_};
  rows.level = {columns_.level.get(), rows_};
  rows.generation = {columns_.generation.get(), rows_};
  rows.links = {columns_.links.get(), rows_ * kDirections};
  return rows;
}

/// Of the columns of the chunk at hand; where it is coded, more than that.
std::size_t SectionWriter::message_bytes() const {
  const std::size_t row = sizeof(double) * row_size_;
  switch (header_.content) {
    case Content::kRequests:
      return rows_ * (sizeof(PointIndex) + sizeof(Level) + sizeof(DirectionMask)) + requests_ * row;
    case Content::kFrontier:
      return rows_ * (2 * sizeof(PointIndex) + sizeof(Level) + sizeof(DirectionMask) + row);
    case Content::kGrid:
      break;
  }
  return rows_ * record_bytes(row_size_);
}

void SectionWriter::flush() {
  if (rows_ == 0) return;
  const auto rows = static_cast<unsigned>(rows_);
  // Each column ends at a word; there are row_size_ + 8 of them at most, and Cap'n Proto's own
  // words.
  const std::size_t words = message_bytes() / sizeof(std::uint64_t) + 11 * row_size_ + 64;
  ChunkInfo info{rows, frontier_, columns_.point[0], columns_.point[rows - 1], {}, 0, conversions_};
  encoder_->write(words, &info, [&](schema::Message::Builder message) {
    if (coder_) return encode_coded(coder_->encode(rows_so_far()), message.initCoded());
    if (header_.content == Content::kRequests) {
      auto chunk = message.initReached();
      copy_column(chunk.initPoint(rows), columns_.point);
      chunk.setLevel(bytes_of(columns_.level, rows));
      copy_column(chunk.initDirections(rows), columns_.directions);
      copy_rows(chunk, static_cast<unsigned>(requests_), columns_.numbers.get(), row_size_,
                header_.spec);
      return;
    }
    auto chunk = message.initRecords();
    copy_column(chunk.initPoint(rows), columns_.point);
    chunk.setLevel(bytes_of(columns_.level, rows));
    copy_column(chunk.initGeneration(rows), columns_.generation);
    copy_rows(chunk, rows, columns_.numbers.get(), row_size_, header_.spec);
    if (header_.content == Content::kGrid) {
      chunk.setLinks(bytes_of(columns_.links, rows * kDirections));
    } else {
      copy_column(chunk.initTodo(rows), columns_.directions);
    }
  });
  footer_.frontier += frontier_;
  footer_.conversions += conversions_;
  footer_.chunks.push_back(info);
  rows_ = requests_ = 0;
  frontier_ = conversions_ = 0;
}

void SectionWriter::finish() {
  flush();
  footer_.digest = encoder_->digest();
  const std::size_t words = 64 + footer_.chunks.size() * sizeof(ChunkInfo) / sizeof(std::uint64_t);
  encoder_->write(words, nullptr, [&](schema::Message::Builder message) {
    encode_footer(footer_, message.initFooter());
  });
  encoder_->drain();
}

}  // namespace hapgrid
