#include "libcore/search/frontier.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <utility>

#include "libcore/base/error.hpp"

namespace hapgrid {

namespace {

std::uint64_t all_conversions(const std::vector<Section>& sections) {
  std::uint64_t total = 0;
  for (const Section& section : sections) total += section.footer.conversions;
  return total;
}

ConversionRange cut(std::uint64_t total, Part part) {
  // Without overflow for any count: the whole parts first, then the rest.
  const auto at = [&](std::uint64_t k) {
    return total / part.of * k + total % part.of * k / part.of;
  };
  return {at(part.number - 1), at(part.number)};
}

std::uint64_t conversions_of(const FrontierReader::Record& record) {
  return static_cast<std::uint64_t>(std::popcount(record.todo));
}

/// The lowest `count` bits that are set, or all where there are fewer.
DirectionMask first_bits(DirectionMask mask, std::uint64_t count) {
  DirectionMask rest = mask;
  for (; rest && count > 0; --count) rest &= rest - 1;
  return mask & ~rest;
}

}  // namespace

FrontierReader::FrontierReader(const std::vector<Section>& sections, Part part)
    : FrontierReader(sections, cut(all_conversions(sections), part)) {}

FrontierReader::FrontierReader(const std::vector<Section>& sections, ConversionRange range)
    : neighbourhood_(sections.front().header.spec.box),
      n_(sections.front().header.spec.state_size),
      generation_(generation_of(sections)),
      rows_(sections),
      state_(n_),
      next_state_(n_) {
  if (sections.front().header.content == Content::kRequests)
    throw FormatError(sections.front().file->name() +
                      ": holds requests where a grid or a frontier is needed");
  require_content(sections, sections.front().header.content);
  const std::uint64_t total = all_conversions(sections);
  begin_ = std::min(range.begin, total);
  end_ = std::clamp(range.end, begin_, total);
  others_follow_ = end_ < total;
}

/// Whether all that a chunk asks for comes before the part. @param in_hand the record before it, if
/// it is not in passed_ yet; a chunk at its point can hold more of it.
bool FrontierReader::is_before_part(const ChunkInfo& chunk, const Record* in_hand) const {
  if (!chunk.counts_conversions() || (in_hand && chunk.first_point <= in_hand->point)) return false;
  return passed_ + (in_hand ? conversions_of(*in_hand) : 0) + chunk.conversions <= begin_;
}

bool FrontierReader::next_row(Record& record, const Record* in_hand) {
  for (;;) {
    if (!run_.rows || run_.begin == run_.end) {
      // Chunks without frontier are passed over as they are stored, and those before the part.
      while (SectionReader* section = rows_.whole_chunk_next()) {
        const ChunkInfo& chunk = *section->peek();
        if (chunk.frontier > 0 && !is_before_part(chunk, in_hand)) break;
        passed_ += chunk.conversions;
        section->next_stored(passed_over_);
      }
      run_ = rows_.next();
    }
    if (!run_.rows) return false;
    const RecordRows& rows = *run_.rows;
    const std::size_t r = run_.begin++;
    if (rows.generation[r] != generation_) continue;
    const PointIndex p = rows.point[r];
    const DirectionMask todo = rows.todo.empty() ? neighbourhood_.inside(p) : rows.todo[r];
    record = {p, rows.level[r], rows.row(r), todo};
    return true;
  }
}

/// Only when the rest is read is the input known to be whole. What other parts are made from they
/// decode; behind the last one nothing may come.
void FrontierReader::read_rest() {
  waiting_ = false;
  do {
    while (SectionReader* section = rows_.whole_chunk_next()) {
      if (!others_follow_ && section->peek()->frontier > 0) break;
      section->next_stored(passed_over_);
    }
    run_ = rows_.next();
  } while (run_.rows);
}

bool FrontierReader::next(Record& record) {
  for (;;) {
    if (passed_ >= end_) {
      read_rest();
      return false;
    }
    if (waiting_) {
      std::swap(state_, next_state_);
      record = next_;
      record.state = state_.data();
      waiting_ = false;
    } else {
      if (!next_row(record, nullptr)) return false;
      std::copy_n(record.state, n_, state_.data());
      record.state = state_.data();
    }
    // Concatenated frontier shards can hold one record twice, with different directions.
    while (next_row(next_, &record)) {
      if (next_.point != record.point || next_.level != record.level) {
        std::copy_n(next_.state, n_, next_state_.data());
        waiting_ = true;
        break;
      }
      if (std::memcmp(next_.state, record.state, n_ * sizeof(double)) != 0)
        throw FormatError("frontier: one record with two different states: point " +
                          std::to_string(record.point) + " level " + std::to_string(record.level));
      record.todo |= next_.todo;
    }
    // The directions whose place in the sequence of conversions lies in the part.
    const std::uint64_t before = passed_;
    passed_ += conversions_of(record);
    if (passed_ <= begin_) continue;
    if (passed_ > end_) record.todo = first_bits(record.todo, end_ - before);
    if (before < begin_) record.todo &= ~first_bits(record.todo, begin_ - before);
    if (record.todo) return true;
  }
}

}  // namespace hapgrid
