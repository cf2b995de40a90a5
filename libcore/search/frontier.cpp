#include "libcore/search/frontier.hpp"

#include <algorithm>
#include <bit>
#include <string>

#include "libcore/base/error.hpp"

namespace hapgrid {

Deal::Deal(std::uint64_t conversions, Part part)
    : total_(conversions),
      part_(part),
      block_(std::max<std::uint64_t>(conversions / (kTurns * part.of), 1)) {}

std::uint64_t Deal::conversions() const {
  const std::uint64_t turn = block_ * part_.of;
  const std::uint64_t rest = total_ % turn;  // of the last turn
  const std::uint64_t before = std::min(rest, (part_.number - 1) * block_);
  return total_ / turn * block_ + std::min(rest - before, block_);
}

bool Deal::has_any(std::uint64_t begin, std::uint64_t end) const {
  const std::uint64_t first = begin / block_;
  const std::uint64_t ahead = (part_.number - 1 + part_.of - first % part_.of) % part_.of;
  return std::max(begin, (first + ahead) * block_) < end;
}

DirectionMask Deal::own(DirectionMask directions, std::uint64_t first) const {
  const auto count = static_cast<std::uint64_t>(std::popcount(directions));
  if (!has_any(first, first + count)) return 0;
  DirectionMask own = 0;
  for (DirectionMask left = directions; left; left &= left - 1, ++first)
    if (is_own(first / block_)) own |= left & -left;
  return own;
}

FrontierReader::FrontierReader(const Section& grid, Part part)
    : grid_(grid),
      neighbourhood_(grid.header.spec.box),
      part_(part),
      deal_(grid.conversions(), part),
      reader_(grid) {
  const std::vector<ChunkInfo>& chunks = grid.footer.chunks;
  const auto asking = std::count_if(chunks.begin(), chunks.end(), [](const ChunkInfo& chunk) {
    return chunk.conversions > 0;
  });
  deals_chunks_ = static_cast<std::uint64_t>(asking) / kManyChunks >= part.of;
  if (!deals_chunks_) {
    conversions_ = deal_.conversions();
    return;
  }
  for (; chunk_ < chunks.size(); ++chunk_)
    if (has_own_chunk()) conversions_ += chunks[chunk_].conversions;
  chunk_ = turn_ = 0;
}

bool FrontierReader::has_own_chunk() {
  const std::uint64_t count = grid_.footer.chunks[chunk_].conversions;
  if (deals_chunks_) return count > 0 && turn_++ % part_.of == part_.number - 1;
  return deal_.has_any(passed_, passed_ + count);
}

bool FrontierReader::next_chunk() {
  for (; chunk_ < grid_.footer.chunks.size(); ++chunk_) {
    if (has_own_chunk()) {
      reader_.read(chunk_++, rows_);
      row_ = 0;
      return true;
    }
    passed_ += grid_.footer.chunks[chunk_].conversions;
  }
  return false;
}

bool FrontierReader::next(Record& record) {
  for (;;) {
    for (; row_ < rows_.size(); ++row_) {
      if (rows_.generation[row_] != grid_.header.generation) continue;
      const PointIndex point = rows_.point[row_];
      const DirectionMask inside = neighbourhood_.inside(point);
      const DirectionMask todo = deals_chunks_ ? inside : deal_.own(inside, passed_);
      passed_ += static_cast<std::uint64_t>(std::popcount(inside));
      if (!todo) continue;
      record = {point, rows_.level[row_], rows_.row(row_), todo};
      ++row_;
      return true;
    }
    if (!next_chunk()) return false;
  }
}

}  // namespace hapgrid
