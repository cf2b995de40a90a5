#include "libcore/search/expand.hpp"

#include <algorithm>
#include <bit>

namespace hapgrid {

std::uint64_t Part::block(std::uint64_t all) const {
  constexpr std::uint64_t kTurns = 512, kLeastTurns = 32;
  constexpr std::uint64_t kLongBlock = 1024;  // conversions; a chunk has some thousand
  const std::uint64_t least = all / (kLeastTurns * of) >= kLongBlock ? kLongBlock : 1;
  return std::max(all / (kTurns * of), least);
}

std::uint64_t Part::size(std::uint64_t all) const {
  const std::uint64_t in_block = block(all), turn = in_block * of;
  const std::uint64_t rest = all % turn;  // of the last turn
  const std::uint64_t before = std::min(rest, (number - 1) * in_block);
  return all / turn * in_block + std::min(rest - before, in_block);
}

bool Part::has_any(std::uint64_t all, std::uint64_t begin, std::uint64_t end) const {
  const std::uint64_t in_block = block(all), first = begin / in_block;
  const std::uint64_t ahead = (number - 1 + of - first % of) % of;
  return std::max(begin, (first + ahead) * in_block) < end;
}

DirectionMask Part::mine(std::uint64_t all, DirectionMask directions, std::uint64_t first) const {
  const auto count = static_cast<std::uint64_t>(std::popcount(directions));
  if (!has_any(all, first, first + count)) return 0;
  const std::uint64_t in_block = block(all);
  DirectionMask mine = 0;
  for (DirectionMask left = directions; left; left &= left - 1, ++first)
    if (first / in_block % of == number - 1) mine |= left & -left;
  return mine;
}

FrontierReader::FrontierReader(const Section& grid, Part part)
    : grid_(grid),
      neighbourhood_(grid.header.spec.box),
      part_(part),
      all_(grid.conversions()),
      reader_(grid) {}

bool FrontierReader::next_chunk() {
  const std::vector<ChunkInfo>& chunks = grid_.chunks;
  for (; chunk_ < chunks.size(); ++chunk_) {
    const std::uint64_t end = passed_ + chunks[chunk_].conversions;
    if (part_.has_any(all_, passed_, end)) {
      reader_.read(chunk_++, rows_);
      row_ = 0;
      return true;
    }
    passed_ = end;
  }
  return false;
}

bool FrontierReader::next(FrontierRecord& record) {
  for (;;) {
    for (; row_ < rows_.size(); ++row_) {
      if (rows_.generation[row_] != grid_.header.generation) continue;
      const PointIndex point = rows_.point[row_];
      const DirectionMask inside = neighbourhood_.inside(point);
      const DirectionMask todo = part_.mine(all_, inside, passed_);
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
