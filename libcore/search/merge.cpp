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

  const std::vector<ChunkInfo>& chunks() const { return section->chunks; }
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
  const Section* section;
  SectionReader reader;
  std::size_t chunk = 0;  // to be read next
  Chunk rows;
  std::size_t row = 0;
};

RequestReader::RequestReader(const std::vector<Section>& sections) {
  if (!sections.empty()) width_ = sections.front().header.spec.row_size();
  rows_.resize(kDirections * width_);
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

bool RequestReader::next(FrontierRecord& source) {
  if (!select_first()) return false;
  const RowKey key = first_->key();
  source = {.point = first_->rows.point[first_->row], .level = first_->rows.level[first_->row]};
  do {
    gather(source);
    ++first_->row;
  } while (select_first() && first_->key() == key);
  return true;
}

/// Puts the rows of first_ among those that are known. What was answered before must be answered
/// again, bit by bit.
void RequestReader::gather(FrontierRecord& source) {
  const Chunk& chunk = first_->rows;
  const DirectionMask directions = chunk.directions[first_->row];
  const double* from = chunk.row(chunk.first[first_->row]);
  for (DirectionMask left = directions; left; left &= left - 1, from += width_) {
    const int q = std::countr_zero(left);
    double* const row = &rows_[static_cast<unsigned>(q) * width_];
    if ((source.todo >> q & 1) && std::memcmp(row, from, width_ * sizeof(double)) != 0)
      throw FormatError(
          format("requests: {}, direction {}: two different answers",
                 describe(first_->section->header.spec.box, source.point, source.level), q));
    std::copy_n(from, width_, row);
  }
  source.todo |= directions;
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

[[noreturn]] void fail_unasked(const GridSpec& spec, const FrontierRecord& source) {
  throw FormatError(
      format("requests: {}, direction {}: the grid's frontier asks for no such conversion",
             describe(spec.box, source.point, source.level), std::countr_zero(source.todo)));
}

/// Copies a grid byte by byte, after a look at all of it.
void copy(const Section& grid, int fd, const std::string& name) {
  SectionReader reader(grid);
  Chunk rows;
  for (std::size_t i = 0; i < grid.chunks.size(); ++i) reader.read(i, rows);
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
  FrontierRecord source;
  if (grid.frontier() == 0) {
    if (reader.next(source)) fail_unasked(header.spec, source);
    return copy(grid, fd, name);
  }
  Levels levels(grid, model);
  while (reader.next(source)) {
    const RecordIndex record = levels.find(source.point, source.level);
    if (record == Grid::kNoRecord || levels.generation(record) != header.generation)
      fail_unasked(header.spec, source);
    levels.settle(record, source.todo, header.generation + 1,
                  [&reader](int q) { return reader.row(q); });
    progress.conversions += static_cast<std::uint64_t>(std::popcount(source.todo));
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
  for (std::size_t i = 0; i < grid.chunks.size(); ++i) {
    reader.read(i, rows);
    out.records(rows, 0, rows.size());
  }
  out.finish();
}

}  // namespace hapgrid
