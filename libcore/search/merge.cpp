#include "libcore/search/merge.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/search/levels.hpp"

namespace hapgrid {

/// One section on its way.
struct RequestReader::Stream {
  explicit Stream(const Section& from) : section(&from), reader(from) {}

  const std::vector<ChunkInfo>& chunks() const { return section->footer.chunks; }
  bool at_end() const { return row == rows.size() && chunk == chunks().size(); }
  bool needs_chunk() const { return row == rows.size(); }
  /// Of the next row; where its chunk is not read yet, a key not behind it.
  RowKey key() const {
    return needs_chunk() ? record_key(chunks()[chunk].first_point, 0)
                         : record_key(rows.point[row], rows.level[row]);
  }
  void read_chunk() {
    const RowKey before = chunk == 0 ? 0 : record_key(rows.point.back(), rows.level.back());
    reader.read(chunk, rows);
    row = 0;
    if (chunk++ > 0 && key() <= before)
      throw FormatError(format("{}: damaged: rows out of order at point {}", section->file->name(),
                               rows.point[0]));
  }
  SourceRequests source() const {
    return {rows.point[row], rows.level[row], rows.directions[row], rows.row(rows.first[row]),
            rows.width};
  }

  const Section* section;
  SectionReader reader;
  std::size_t chunk = 0;  // to be read next
  Chunk rows;
  std::size_t row = 0;
};

RequestReader::RequestReader(const std::vector<Section>& sections) {
  for (const Section& section : sections) push(std::make_unique<Stream>(section));
}
RequestReader::~RequestReader() = default;

bool RequestReader::later(const std::unique_ptr<Stream>& a, const std::unique_ptr<Stream>& b) {
  return a->key() > b->key();
}

void RequestReader::push(std::unique_ptr<Stream> stream) {
  if (stream->at_end()) return;
  heap_.push_back(std::move(stream));
  std::push_heap(heap_.begin(), heap_.end(), later);
}

/// Puts the stream with the smallest key into first_, with its next row read. False behind all
/// rows.
bool RequestReader::select_first() {
  for (;;) {
    if (first_ && first_->at_end()) first_.reset();
    if (first_ && !heap_.empty() && heap_.front()->key() < first_->key()) push(std::move(first_));
    if (!first_) {
      if (heap_.empty()) return false;
      std::pop_heap(heap_.begin(), heap_.end(), later);
      first_ = std::move(heap_.back());
      heap_.pop_back();
    }
    if (!first_->needs_chunk()) return true;
    first_->read_chunk();
  }
}

bool RequestReader::next(SourceRequests& source) {
  if (given_) ++first_->row;
  given_ = false;
  if (!select_first()) return false;
  source = first_->source();
  const RowKey key = first_->key();
  given_ = heap_.empty() || heap_.front()->key() > key;
  if (given_) return true;
  source.directions = 0;
  do {
    gather(first_->source(), source.directions);
    ++first_->row;
  } while (select_first() && first_->key() == key);
  rows_.clear();
  for (DirectionMask left = source.directions; left; left &= left - 1) {
    const double* const row =
        &spread_[static_cast<unsigned>(std::countr_zero(left)) * source.width];
    rows_.insert(rows_.end(), row, row + source.width);
  }
  source.rows = rows_.data();
  return true;
}

/// Puts the rows of `more` among those of the `known` directions. What was answered before must be
/// answered again, bit by bit.
void RequestReader::gather(const SourceRequests& more, DirectionMask& known) {
  spread_.resize(kDirections * more.width);
  for (DirectionMask left = more.directions; left; left &= left - 1) {
    const int q = std::countr_zero(left);
    double* const row = &spread_[static_cast<unsigned>(q) * more.width];
    if ((known >> q & 1) && std::memcmp(row, more.row(q), more.width * sizeof(double)) != 0)
      throw FormatError(format("requests: {}, direction {}: two different answers",
                               describe(first_->section->header.spec.box, more.point, more.level),
                               q));
    std::copy_n(more.row(q), more.width, row);
  }
  known |= more.directions;
}

Section take_grid(std::vector<Section>& sections) {
  const auto is_grid = [](const Section& section) {
    return section.header.content == Content::kGrid;
  };
  const auto found = std::find_if(sections.begin(), sections.end(), is_grid);
  if (found == sections.end())
    throw FormatError(
        format("{}: requests, but no grid to merge them into", sections.front().file->name()));
  Section grid = std::move(*found);
  sections.erase(found);
  const auto second = std::find_if(sections.begin(), sections.end(), is_grid);
  if (second != sections.end())
    throw FormatError(
        format("{}: a second grid, beside {}", second->file->name(), grid.file->name()));
  for (const Section& section : sections)
    if (section.header.generation != grid.header.generation)
      throw FormatError(format("{}: requests of generation {}, the grid's frontier is {}",
                               section.file->name(), section.header.generation,
                               grid.header.generation));
  return grid;
}

SectionHeader merged_header(const Section& grid) {
  SectionHeader header = grid.header;
  if (grid.frontier() > 0) ++header.generation;
  return header;
}

namespace {

[[noreturn]] void fail_unasked(const GridSpec& spec, const SourceRequests& source) {
  throw FormatError(
      format("requests: {}, direction {}: the grid's frontier asks for no such conversion",
             describe(spec.box, source.point, source.level), std::countr_zero(source.directions)));
}

/// Copies a grid byte by byte, after a look at all of it.
void copy(const Section& grid, int fd, const std::string& name) {
  SectionReader reader(grid);
  Chunk rows;
  for (std::size_t i = 0; i < grid.footer.chunks.size(); ++i) reader.read(i, rows);
  std::vector<std::byte> bytes;
  for (std::uint64_t at = grid.begin; at < grid.end; at += bytes.size()) {
    bytes.resize(std::min<std::uint64_t>(grid.end - at, 1 << 20));
    if (grid.file->read(at, bytes) != bytes.size())
      throw FormatError(format("{}: became shorter while it was read", grid.file->name()));
    write_all(fd, bytes, name);
  }
}

}  // namespace

void merge(const Section& grid, const std::vector<Section>& requests, const Model& model, int fd,
           const std::string& name, Progress& progress) {
  const SectionHeader& header = grid.header;
  RequestReader reader(requests);
  SourceRequests source;
  if (grid.frontier() == 0) {
    if (reader.next(source)) fail_unasked(header.spec, source);
    return copy(grid, fd, name);
  }
  Levels levels(grid, model);
  while (reader.next(source)) {
    const RecordIndex record = levels.find(source.point, source.level);
    if (record == Grid::kNoRecord || levels.generation(record) != header.generation)
      fail_unasked(header.spec, source);
    levels.settle(record, source.directions, header.generation + 1,
                  [&source](int q) { return source.row(q); });
    progress.conversions += static_cast<std::uint64_t>(std::popcount(source.directions));
  }
  levels.require_settled(header.generation);
  SectionWriter out(fd, name, merged_header(grid));
  levels.write(out);
}

void copy_finished(const Section& grid, SectionWriter& out) {
  if (grid.frontier() > 0)
    throw Error(
        format("{}: {} records are still in the frontier; only a finished grid can be made small",
               grid.file->name(), grid.frontier()));
  SectionReader reader(grid);
  Chunk rows;
  for (std::size_t i = 0; i < grid.footer.chunks.size(); ++i) {
    reader.read(i, rows);
    out.records(rows, 0, rows.size());
  }
  out.finish();
}

}  // namespace hapgrid
