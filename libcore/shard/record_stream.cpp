#include "libcore/shard/record_stream.hpp"

#include <algorithm>
#include <utility>

namespace hapgrid {

namespace {

/// The first of rows [begin, ...) that is at `point` or behind it.
std::size_t first_at(const RecordRows& rows, std::size_t begin, std::uint64_t point) {
  const auto from = rows.point.begin() + static_cast<std::ptrdiff_t>(begin);
  return static_cast<std::size_t>(std::lower_bound(from, rows.point.end(), point) -
                                  rows.point.begin());
}

}  // namespace

SectionReader& RecordStream::reader() {
  if (!reader_) reader_.emplace(*section_);
  return *reader_;
}

const ChunkInfo* RecordStream::next_chunk() const {
  if (reader_) return reader_->peek();
  const std::vector<ChunkInfo>& chunks = section_->footer.chunks;
  return chunks.empty() ? nullptr : &chunks.front();
}

RecordStream::Fetched& RecordStream::fetch() {
  if (spare_.empty()) {
    fetched_.push_back(std::make_unique<Fetched>());
  } else {
    fetched_.push_back(std::move(spare_.back()));
    spare_.pop_back();
  }
  Fetched& chunk = *fetched_.back();
  chunk.is_decoded = false;
  chunk.position = 0;
  return chunk;
}

RecordStream::Fetched& RecordStream::fetch_decoded() {
  Fetched& chunk = fetch();
  chunk.is_decoded = true;
  reader().next(chunk.rows);
  chunk.position = first_at(chunk.rows, 0, from_);
  return chunk;
}

void RecordStream::fetch_stored() { reader().next_stored(fetch().stored); }

RecordStream::Fetched& RecordStream::front() {
  if (fetched_.empty()) return fetch_decoded();
  Fetched& chunk = *fetched_.front();
  if (!chunk.is_decoded) {
    reader().decode(chunk.stored, chunk.rows);
    chunk.is_decoded = true;
    chunk.position = first_at(chunk.rows, 0, from_);
  }
  return chunk;
}

void RecordStream::drop_front() {
  if (taken_) spare_.push_back(std::move(taken_));
  taken_ = std::move(fetched_.front());
  fetched_.pop_front();
}

std::uint64_t RecordStream::next_point() const {
  if (!fetched_.empty()) {
    const Fetched& chunk = *fetched_.front();
    return chunk.is_decoded ? chunk.rows.point[chunk.position] : chunk.stored.info.first_point;
  }
  const ChunkInfo* next = next_chunk();
  return next ? next->first_point : ~std::uint64_t{0};
}

void RecordStream::skip_before(std::uint64_t point) {
  from_ = point;
  while (!fetched_.empty()) {
    Fetched& chunk = *fetched_.front();
    if (!chunk.is_decoded) {
      if (chunk.stored.info.last_point >= point) return;
    } else {
      chunk.position = first_at(chunk.rows, chunk.position, point);
      if (chunk.position < chunk.rows.size()) return;
    }
    drop_front();
  }
  for (const ChunkInfo* next = next_chunk(); next && next->last_point < point; next = next_chunk())
    reader().pass_over();
}

Run<RecordRows> RecordStream::next_before(std::uint64_t end) {
  if (next_point() >= end) return {};
  Fetched& chunk = front();
  const std::size_t begin = chunk.position;
  if (chunk.rows.point[begin] >= end) return {};
  chunk.position = first_at(chunk.rows, begin, end);
  const Run<RecordRows> run{&chunk.rows, begin, chunk.position};
  if (chunk.position == chunk.rows.size()) drop_front();
  return run;
}

bool RecordStream::is_stored_before(std::uint64_t end) const {
  if (section_->header.coding.is_coded) return false;
  const auto fits = [end](const ChunkInfo& chunk) {
    return chunk.first_point >= end || chunk.last_point < end;
  };
  for (const auto& chunk : fetched_) {
    if (chunk->is_decoded ? chunk->rows.point[chunk->position] < end : !fits(chunk->stored.info))
      return false;
  }
  const ChunkInfo* const last = section_->footer.chunks.data() + section_->footer.chunks.size();
  for (const ChunkInfo* next = next_chunk(); next && next != last && next->first_point < end;
       ++next)
    if (!fits(*next)) return false;
  return true;
}

void RecordStream::take_stored(StoredChunk& chunk) {
  if (fetched_.empty()) return reader().next_stored(chunk);
  std::swap(chunk, fetched_.front()->stored);
  drop_front();
}

void RecordStream::finish() {
  while (!fetched_.empty()) drop_front();
  while (reader().peek()) reader().pass_over();
  RecordRows none;
  reader().next(none);
}

}  // namespace hapgrid
