#include "libcore/shard/writer.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

#include "libcore/base/file.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/shard/schema.hpp"

namespace hapgrid {

namespace {

/// Room for a header. Do not change: a larger header is split here, and another number would change
/// the bytes of existing grids.
constexpr std::size_t kHeaderWords = 1279;

/// How chunks are compressed. Speed counts, and links and smooth states compress nearly as well at
/// level 1 as at level 3; above all in requests, which are written and read once. What is to be
/// small is written once and kept.
ZstdFrameEncoder encoder_for(Content content, Packing packing) {
  if (content != Content::kGrid) return ZstdFrameEncoder(-1);
  return ZstdFrameEncoder(packing == Packing::kSmall ? 19 : 1);
}

template <class List, class T>
void copy_column(List list, const std::unique_ptr<T[]>& column) {
  const std::span<T> to = column_to_fill<T>(list);
  std::memcpy(to.data(), column.get(), to.size_bytes());
}

/// The numbers [first, last) of each row, component by component. `numbers` is row-major.
template <class T>
void copy_components(typename capnp::List<T>::Builder list, const double* numbers,
                     std::size_t width, std::uint32_t first, std::uint32_t last) {
  T* const out = column_to_fill<T>(list).data();
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

/// Messages to zstd frames, the index and the file.
class SectionWriter::Encoder {
 public:
  Encoder(int fd, std::string name, ZstdFrameEncoder encoder)
      : fd_(fd), name_(std::move(name)), zstd_(std::move(encoder)) {}

  /// Builds one message of some `words` with `fill(schema::Message::Builder)`, and writes it.
  /// Answers its zstd frame, valid until the next call.
  template <class Fill>
  std::span<const std::byte> write(std::size_t words, Fill&& fill) {
    build_message<schema::Message>(words, scratch_, message_, fill);
    const auto bytes = std::as_bytes(std::span(message_));
    const std::span<const std::byte> frame = zstd_.encode(bytes);
    digest_ = digest_of(bytes);
    size_ = static_cast<std::uint32_t>(frame.size());
    put(frame);
    return frame;
  }

  // Of the message written last.
  Digest digest() const { return digest_; }
  std::uint32_t size() const { return size_; }

  /// Zstd frames of a grid are a few KiB each, and a call of the system for each would cost more
  /// than to copy them.
  void put(std::span<const std::byte> bytes) {
    pending_.insert(pending_.end(), bytes.begin(), bytes.end());
    if (pending_.size() >= kWriteBytes) drain();
  }

  /// Everything is in the file.
  void drain() {
    write_all(fd_, pending_, name_);
    pending_.clear();
  }

 private:
  static constexpr std::size_t kWriteBytes = 128 << 10;

  int fd_;
  std::string name_;
  ZstdFrameEncoder zstd_;
  std::vector<std::byte> pending_;  // not written yet
  Digest digest_;
  std::uint32_t size_ = 0;
  MessageWords scratch_;
  MessageWords message_;
};

SectionWriter::SectionWriter(int fd, const std::string& name, const SectionHeader& header,
                             Packing packing)
    : row_size_(header.spec.row_size()),
      neighbourhood_(header.spec.box),
      encoder_(std::make_unique<Encoder>(fd, name, encoder_for(header.content, packing))),
      row_limit_(header.content != Content::kGrid ? chunk_requests(row_size_)
                 : packing == Packing::kSmall     ? chunk_points(row_size_, kLargeChunkBytes)
                                                  : chunk_points(row_size_)) {
  section_.header = header;
  const std::size_t rows = row_limit_;
  point_ = std::make_unique_for_overwrite<PointIndex[]>(rows);
  level_ = std::make_unique_for_overwrite<Level[]>(rows);
  numbers_ = std::make_unique_for_overwrite<double[]>(rows * row_size_);
  if (header.content == Content::kGrid) {
    generation_ = std::make_unique_for_overwrite<std::uint32_t[]>(rows);
    links_ = std::make_unique_for_overwrite<Level[]>(rows * kDirections);
  } else {
    directions_ = std::make_unique_for_overwrite<DirectionMask[]>(rows);
  }
  encoder_->write(kHeaderWords, [&](schema::Message::Builder message) {
    encode_header(header, message.initHeader());
  });
  section_.header_size = encoder_->size();
  header_digest_ = encoder_->digest();
}
SectionWriter::~SectionWriter() = default;
SectionWriter::SectionWriter(SectionWriter&&) noexcept = default;

void SectionWriter::record(PointIndex point, Level level, std::uint32_t generation,
                           const double* row_numbers, const Level* links) {
  enter_range(point);
  if (rows_ == row_limit_) flush();
  point_[rows_] = point;
  level_[rows_] = level;
  generation_[rows_] = generation;
  std::copy_n(row_numbers, row_size_, &numbers_[rows_ * row_size_]);
  std::memcpy(&links_[rows_ * kDirections], links, kDirections);
  count_frontier(point, generation);
  ++rows_;
}

void SectionWriter::records(const RecordRun& rows, std::size_t begin, std::size_t end) {
  const auto copy = [&](const auto& from, auto* to, std::size_t each, std::size_t count) {
    std::memcpy(to + rows_ * each, from.data() + begin * each, count * each * sizeof *to);
  };
  while (begin < end) {
    enter_range(rows.point[begin]);
    if (rows_ == row_limit_) flush();
    std::size_t stop = std::min(end, begin + row_limit_ - rows_);
    while (rows.point[stop - 1] >= range_end_) --stop;
    copy(rows.point, point_.get(), 1, stop - begin);
    copy(rows.level, level_.get(), 1, stop - begin);
    copy(rows.generation, generation_.get(), 1, stop - begin);
    copy(rows.rows, numbers_.get(), row_size_, stop - begin);
    copy(rows.links, links_.get(), kDirections, stop - begin);
    for (std::size_t r = begin; r < stop; ++r) count_frontier(rows.point[r], rows.generation[r]);
    rows_ += stop - begin;
    begin = stop;
  }
}

void SectionWriter::enter_range(PointIndex point) {
  if (point < range_end_) return;
  flush();
  range_end_ = (std::uint64_t{point} / row_limit_ + 1) * row_limit_;
}

void SectionWriter::count_frontier(PointIndex point, std::uint32_t generation) {
  if (generation != section_.header.generation) return;
  ++frontier_;
  conversions_ += static_cast<std::uint32_t>(std::popcount(neighbourhood_.inside(point)));
}

void SectionWriter::requests(PointIndex point, Level level, DirectionMask directions,
                             const double* rows) {
  const auto count = static_cast<std::uint32_t>(std::popcount(directions));
  if (conversions_ + count > row_limit_) flush();
  point_[rows_] = point;
  level_[rows_] = level;
  directions_[rows_] = directions;
  ++rows_;
  double* to = &numbers_[std::size_t{conversions_} * row_size_];
  for (DirectionMask left = directions; left; left &= left - 1, to += row_size_)
    std::copy_n(rows + static_cast<std::size_t>(std::countr_zero(left)) * row_size_, row_size_, to);
  conversions_ += count;
}

void SectionWriter::flush() {
  if (rows_ == 0) return;
  const auto rows = static_cast<unsigned>(rows_);
  // Each column ends at a word; there are row_size_ + 8 of them at most, and Cap'n Proto's own
  // words.
  const unsigned numbers = section_.header.content == Content::kGrid ? rows : conversions_;
  const std::size_t bytes = (std::size_t{rows} + numbers) * (record_bytes(row_size_) + kDirections);
  encoder_->write(bytes / sizeof(std::uint64_t) + 64, [&](schema::Message::Builder message) {
    const auto fill_keys = [&](auto chunk) {
      copy_column(chunk.initPoint(rows), point_);
      chunk.setLevel(bytes_of(level_, rows));
      return chunk;
    };
    if (section_.header.content == Content::kRequests) {
      auto chunk = fill_keys(message.initRequests());
      copy_column(chunk.initDirections(rows), directions_);
      copy_rows(chunk, numbers, numbers_.get(), row_size_, section_.header.spec);
    } else {
      auto chunk = fill_keys(message.initRecords());
      copy_column(chunk.initGeneration(rows), generation_);
      copy_rows(chunk, numbers, numbers_.get(), row_size_, section_.header.spec);
      chunk.setLinks(bytes_of(links_, rows * kDirections));
    }
  });
  ChunkInfo info;
  info.size = encoder_->size();
  info.rows = rows;
  info.frontier = frontier_;
  info.conversions = conversions_;
  info.first_point = point_[0];
  info.last_point = point_[rows - 1];
  info.digest = encoder_->digest();
  section_.chunks.push_back(info);
  rows_ = 0;
  frontier_ = conversions_ = 0;
}

void SectionWriter::finish() {
  flush();
  section_.digest = section_digest(header_digest_, section_.chunks);
  const std::size_t words = 64 + section_.chunks.size() * sizeof(ChunkInfo) / sizeof(std::uint64_t);
  const auto frame = encoder_->write(words, [&](schema::Message::Builder message) {
    encode_footer(section_, message.initFooter());
  });
  const Locator locator{.footer = frame.size()};
  encoder_->put(std::as_bytes(std::span(&locator, 1)));
  encoder_->drain();
}

}  // namespace hapgrid
