#include "libcore/shard/reader.hpp"

#include <capnp/serialize.h>
#include <kj/exception.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/shard/frame.hpp"
#include "libcore/shard/schema.hpp"

namespace hapgrid {

namespace {

// A header carries the model's parameters in full; a footer some 50 bytes a chunk.
constexpr std::uint64_t kMaxHeaderBytes = 8 << 20;
constexpr std::uint64_t kMaxFooterBytes = 64 << 20;

/// The largest message that a section can hold: a chunk near 1 MiB, or a single large row.
std::uint64_t chunk_limit(std::uint32_t state_size) {
  return (4 << 20) + 4 * record_bytes(state_size);
}
/// Decodes one message and hands it to `use`; everything that Cap'n Proto throws becomes a
/// FormatError.
template <class F>
auto read_message(const std::vector<std::uint64_t>& words, const std::string& where, F&& use) {
  try {
    capnp::ReaderOptions options;
    // Columns are looked at once to validate and once to copy; lists of texts in headers more.
    options.traversalLimitInWords = 4 * words.size() + 1024;
    options.nestingLimit = 8;
    const auto* begin = reinterpret_cast<const capnp::word*>(words.data());
    capnp::FlatArrayMessageReader reader(kj::arrayPtr(begin, words.size()), options);
    if (reader.getEnd() != begin + words.size())
      throw FormatError("bytes behind the message in a frame");
    return use(reader.getRoot<schema::Message>());
  } catch (const FormatError& e) {
    throw FormatError(where + ": " + e.what());
  } catch (const kj::Exception& e) {
    throw FormatError(where + ": damaged: " + std::string(e.getDescription().cStr()));
  }
}

std::string at(const InputFile& file, std::uint64_t offset) {
  return file.name() + ": byte " + std::to_string(offset);
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

/// The states of a chunk, row-major.
std::span<const double> state_column(capnp::List<double>::Reader list, std::size_t rows,
                                     std::uint32_t n, std::vector<double>& transposed) {
  const std::span<const double> in = column<double>(list, rows * n, "state");
  if (n == 1) return in;
  transposed.resize(rows * n);
  for (std::uint32_t c = 0; c < n; ++c)
    for (std::size_t r = 0; r < rows; ++r) transposed[r * n + c] = in[c * rows + r];
  return transposed;
}

}  // namespace

std::vector<Section> open_sections(const std::shared_ptr<const InputFile>& file) {
  if (file->size() == 0) throw FormatError(file->name() + ": empty, not a shard");
  constexpr std::uint64_t kMaxFrame = kMaxFooterBytes;
  FrameReader frames(*file, 0, file->size());
  FrameDecoder decoder;
  std::vector<std::uint64_t> words;
  std::vector<std::uint64_t> offsets;
  while (!frames.at_end()) {
    offsets.push_back(frames.offset());
    frames.next(kMaxFrame);
  }
  offsets.push_back(file->size());
  const auto message = [&](std::size_t frame, std::uint64_t limit, auto&& use) {
    frames.seek(offsets[frame]);
    const std::string where = at(*file, offsets[frame]);
    try {
      decoder.decode(frames.next(kMaxFrame), limit, words);
    } catch (const FormatError& e) {
      throw FormatError(where + ": " + e.what());
    }
    read_message(words, where, use);
  };
  // From the end backwards: a footer says how many chunks stand between it and its header.
  std::vector<Section> found;
  for (std::size_t end = offsets.size() - 1; end > 0;) {
    Section section;
    section.file = file;
    section.end = offsets[end];
    message(end - 1, kMaxFooterBytes, [&](schema::Message::Reader last) {
      if (!last.isFooter()) throw FormatError("truncated: the shard does not end with a footer");
      section.footer = decode_footer(last.getFooter());
    });
    const std::size_t chunks = section.footer.chunks.size();
    if (chunks + 2 > end)
      throw FormatError(file->name() + ": truncated: a footer counts " + std::to_string(chunks) +
                        " chunks, " + std::to_string(end - 1) + " messages stand before it");
    const std::size_t first = end - 2 - chunks;
    section.begin = offsets[first + 1];
    section.stored_bytes = section.end - offsets[first];
    message(first, kMaxHeaderBytes, [&](schema::Message::Reader head) {
      if (!head.isHeader()) throw FormatError("damaged: no header where a footer's section starts");
      section.header = decode_header(head.getHeader());
      SectionDigester digester(std::as_bytes(std::span(words)));
      for (const ChunkInfo& chunk : section.footer.chunks) digester.add(chunk.digest);
      if (digester.digest() != section.footer.digest)
        throw FormatError("damaged: the digest in the footer does not fit the content");
    });
    found.push_back(std::move(section));
    end = first;
  }
  std::reverse(found.begin(), found.end());
  return found;
}

std::vector<Section> open_sections(const std::vector<std::string>& names) {
  std::vector<Section> sections;
  for (const std::string& name : names) {
    std::vector<Section> found = open_sections(std::make_shared<const InputFile>(name));
    sections.insert(sections.end(), std::make_move_iterator(found.begin()),
                    std::make_move_iterator(found.end()));
  }
  for (const Section& section : sections) {
    const Section& first = sections.front();
    if (section.header.spec == first.header.spec) continue;
    throw FormatError(section.file->name() + ": another grid than " + first.file->name() + ": " +
                      difference(section.header.spec, first.header.spec));
  }
  return sections;
}

void require_content(const std::vector<Section>& sections, Content content) {
  for (const Section& section : sections) {
    if (section.header.content != content)
      throw FormatError(section.file->name() + ": holds " + to_string(section.header.content) +
                        " where a shard of " + to_string(content) + " is needed");
    const std::uint32_t expected = sections.front().header.generation;
    if (section.header.generation != expected)
      throw FormatError(
          section.file->name() + ": generation " + std::to_string(section.header.generation) +
          ", but " + sections.front().file->name() + " has generation " + std::to_string(expected));
  }
}

class SectionReader::State {
 public:
  explicit State(const Section& section)
      : section_(&section),
        neighbourhood_(section.header.spec.box),
        frames_(*section.file, section.begin, section.end) {}

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
    decode_frame(frames_.next(limit()), *info, rows);
    count(*info);
    return true;
  }

  void next_stored(StoredChunk& chunk) {
    chunk.info = *peek();
    where_ = at(*section_->file, frames_.offset());
    const std::span<const std::byte> frame = frames_.next(limit());
    if (hash_of(frame) != chunk.info.stored)
      throw FormatError(where_ + ": damaged: a chunk does not fit the footer's hash of it");
    if (any_ && chunk.info.first_point < key_point(last_))
      throw FormatError(where_ + ": damaged: chunks out of order");
    chunk.frame.assign(frame.begin(), frame.end());
    count(chunk.info);
    any_ = true;
    last_ = record_key(chunk.info.last_point, 0);
  }

  void decode_stored(const StoredChunk& chunk, RecordRows& rows) {
    const bool any = std::exchange(any_, false);
    const RowKey last = last_;
    const std::uint64_t conversions = conversions_;
    where_ =
        section_->file->name() + ": chunk from point " + std::to_string(chunk.info.first_point);
    decode_frame(chunk.frame, chunk.info, rows);
    any_ = any;
    last_ = last;
    conversions_ = conversions;
  }

 private:
  const GridSpec& spec() const { return section_->header.spec; }
  std::uint64_t limit() const { return chunk_limit(spec().state_size); }

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
      read(message, rows);
      if (rows.size() != info.rows || key_point(last_) != info.last_point ||
          first_point(rows) != info.first_point || frontier_ != info.frontier)
        throw FormatError("damaged: a chunk does not fit what the footer says of it");
    });
  }

  static PointIndex first_point(const RecordRows& rows) { return rows.point[0]; }
  static PointIndex first_point(const RequestRows& rows) { return rows.target[0]; }

  void count(const ChunkInfo& info) {
    ++next_;
    rows_ += info.rows;
    frontier_sum_ += info.frontier;
  }

  /// Compares the footer's sums with what was read.
  void finish() const {
    const SectionFooter& footer = section_->footer;
    const bool requests = section_->header.content == Content::kRequests;
    if (footer.records != (requests ? 0 : rows_) || footer.requests != (requests ? rows_ : 0) ||
        footer.frontier != frontier_sum_ || footer.conversions != conversions_)
      throw FormatError(section_->file->name() +
                        ": damaged: the counts in the footer do not fit the content");
  }

  void read(schema::Message::Reader message, RecordRows& rows) {
    if (!message.isRecords()) throw FormatError("damaged: a chunk of records was expected");
    const schema::RecordChunk::Reader chunk = message.getRecords();
    const std::uint32_t n = spec().state_size;
    const std::size_t count = chunk.getPoint().size();
    const bool grid = section_->header.content == Content::kGrid;
    if (count == 0) throw FormatError("damaged: a chunk without rows");
    rows.point = column<PointIndex>(chunk.getPoint(), count, "point");
    rows.level = column(chunk.getLevel(), count, "level");
    rows.generation = column<std::uint32_t>(chunk.getGeneration(), count, "generation");
    rows.state = state_column(chunk.getState(), count, n, rows.transposed);
    rows.links = column(chunk.getLinks(), grid ? count * kDirections : 0, "links");
    rows.todo = column<DirectionMask>(chunk.getTodo(), grid ? 0 : count, "todo");
    for (std::size_t r = 0; r < count; ++r) {
      const PointIndex p = rows.point[r];
      check_row(p, record_key(p, rows.level[r]), rows.level[r]);
      const bool in_frontier = rows.generation[r] == section_->header.generation;
      if (rows.generation[r] > section_->header.generation || (!grid && !in_frontier))
        throw FormatError("damaged: a record of generation " + std::to_string(rows.generation[r]));
      if (!in_frontier) continue;
      const DirectionMask inside = neighbourhood_.inside(p);
      if (!grid && (rows.todo[r] & ~inside))
        throw FormatError("damaged: a direction to be expanded leaves the box");
      conversions_ += static_cast<std::uint64_t>(std::popcount(grid ? inside : rows.todo[r]));
      ++frontier_;
    }
  }

  void read(schema::Message::Reader message, RequestRows& rows) {
    if (!message.isRequests()) throw FormatError("damaged: a chunk of requests was expected");
    const schema::RequestChunk::Reader chunk = message.getRequests();
    const std::uint32_t n = spec().state_size;
    const std::size_t count = chunk.getTarget().size();
    if (count == 0) throw FormatError("damaged: a chunk without rows");
    rows.target = column<PointIndex>(chunk.getTarget(), count, "target");
    rows.direction = column(chunk.getDirection(), count, "direction");
    rows.level = column(chunk.getLevel(), count, "level");
    rows.state = state_column(chunk.getState(), count, n, rows.transposed);
    for (std::size_t r = 0; r < count; ++r) {
      const PointIndex t = rows.target[r];
      const int q = rows.direction[r];
      if (q >= kDirections) throw FormatError("damaged: a direction beyond 25");
      check_row(t, request_key(t, q, rows.level[r]), rows.level[r]);
      if (t != inside_point_) {
        inside_point_ = t;
        inside_mask_ = neighbourhood_.inside(t);
      }
      // The way back must stay inside, or the source would not be a point of the box.
      if (!(inside_mask_ >> Direction(q).opposite().q() & 1))
        throw FormatError("damaged: a request from outside the box");
    }
    for (const double component : rows.state)
      if (!std::isfinite(component)) throw FormatError("damaged: a request's state is not finite");
  }

  void check_row(PointIndex point, RowKey key, Level level) {
    if (point >= spec().box.points())
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
  FrameReader frames_;
  FrameDecoder decoder_;
  std::string where_;       // the chunk at hand, for messages
  std::size_t next_ = 0;    // chunk
  std::uint64_t rows_ = 0;  // of the chunks before it
  std::uint64_t frontier_sum_ = 0;
  std::uint64_t conversions_ = 0;
  std::uint32_t frontier_ = 0;  // of the chunk at hand
  bool any_ = false;
  RowKey last_ = 0;
  PointIndex inside_point_ = std::numeric_limits<PointIndex>::max();
  DirectionMask inside_mask_ = 0;
};

SectionReader::SectionReader(const Section& section) : state_(std::make_unique<State>(section)) {}
SectionReader::~SectionReader() = default;
SectionReader::SectionReader(SectionReader&&) noexcept = default;

bool SectionReader::next(RecordRows& rows) { return state_->next(rows); }
bool SectionReader::next(RequestRows& rows) { return state_->next(rows); }
const ChunkInfo* SectionReader::peek() const { return state_->peek(); }
void SectionReader::next_stored(StoredChunk& chunk) { state_->next_stored(chunk); }
void SectionReader::decode(const StoredChunk& chunk, RecordRows& rows) {
  state_->decode_stored(chunk, rows);
}

namespace {
RowKey key(const RecordRows& rows, std::size_t r) {
  return record_key(rows.point[r], rows.level[r]);
}
RowKey key(const RequestRows& rows, std::size_t r) {
  return request_key(rows.target[r], rows.direction[r], rows.level[r]);
}
}  // namespace

template <class Rows>
struct MergedRows<Rows>::Source {
  explicit Source(const Section& section) : reader(section) {}
  RowKey head() const { return key(rows, position); }
  /// Makes head() valid; false behind the last row.
  bool fill() {
    while (position == rows.size()) {
      position = 0;
      if (!reader.next(rows)) return false;
    }
    return true;
  }

  SectionReader reader;
  Rows rows;
  std::size_t position = 0;
};

template <class Rows>
MergedRows<Rows>::MergedRows(const std::vector<Section>& sections) {
  for (const Section& section : sections) waiting_.push_back(&section);
  std::stable_sort(waiting_.begin(), waiting_.end(), [](const Section* a, const Section* b) {
    return a->footer.first_point() > b->footer.first_point();
  });
}

template <class Rows>
MergedRows<Rows>::~MergedRows() = default;

template <class Rows>
void MergedRows<Rows>::open_next() {
  open_.push_back(std::make_unique<Source>(*waiting_.back()));
  waiting_.pop_back();
  if (!open_.back()->fill()) open_.pop_back();
}

template <class Rows>
void MergedRows<Rows>::end_run() {
  // The rows of the last run are given back only now.
  if (current_ && !current_->fill())
    std::erase_if(open_, [&](const auto& source) { return source.get() == current_; });
  current_ = nullptr;
}

template <class Rows>
SectionReader* MergedRows<Rows>::whole_chunk_next() {
  if (open_.empty() && waiting_.size() == 1) {
    open_.push_back(std::make_unique<Source>(*waiting_.back()));
    waiting_.pop_back();
    current_ = open_.back().get();
  }
  if (!waiting_.empty() || open_.size() != 1) return nullptr;
  Source& source = *open_.front();
  return source.position == source.rows.size() && source.reader.peek() ? &source.reader : nullptr;
}

template <class Rows>
Run<Rows> MergedRows<Rows>::next() {
  end_run();
  while (open_.empty() && !waiting_.empty()) open_next();
  if (open_.empty()) return {};
  const auto smallest = [&] {
    return std::min_element(open_.begin(), open_.end(),
                            [](const auto& a, const auto& b) { return a->head() < b->head(); })
        ->get();
  };
  Source* source = smallest();
  while (!waiting_.empty() && waiting_.back()->footer.first_point() <= key_point(source->head())) {
    open_next();
    source = smallest();
  }
  // The run ends where another source, or a section that is still closed, has the next row.
  RowKey limit = std::numeric_limits<RowKey>::max();
  for (const auto& other : open_)
    if (other.get() != source) limit = std::min(limit, other->head());
  if (!waiting_.empty())
    limit = std::min(limit, record_key(waiting_.back()->footer.first_point(), 0));
  const Rows& rows = source->rows;
  const std::size_t begin = source->position;
  std::size_t end = begin + 1;
  if (key(rows, rows.size() - 1) < limit) {
    end = rows.size();
  } else {
    while (end < rows.size() && key(rows, end) < limit) ++end;
  }
  source->position = end;
  current_ = source;
  return {&rows, begin, end};
}

template class MergedRows<RecordRows>;
template class MergedRows<RequestRows>;

}  // namespace hapgrid
