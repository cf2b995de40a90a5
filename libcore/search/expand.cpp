#include "libcore/search/expand.hpp"

#include <algorithm>
#include <bit>

namespace hapgrid {

Partition::Partition(std::uint64_t items, Part part)
    : total_(items), part_(part), block_(std::max<std::uint64_t>(items / (kTurns * part.of), 1)) {
  if (items / (kLeastTurns * part.of) >= kLongBlock) block_ = std::max(block_, kLongBlock);
}

std::uint64_t Partition::size() const {
  const std::uint64_t turn = block_ * part_.of;
  const std::uint64_t rest = total_ % turn;  // of the last turn
  const std::uint64_t before = std::min(rest, (part_.number - 1) * block_);
  return total_ / turn * block_ + std::min(rest - before, block_);
}

bool Partition::has_any(std::uint64_t begin, std::uint64_t end) const {
  const std::uint64_t first = begin / block_;
  const std::uint64_t ahead = (part_.number - 1 + part_.of - first % part_.of) % part_.of;
  return std::max(begin, (first + ahead) * block_) < end;
}

DirectionMask Partition::mine(DirectionMask directions, std::uint64_t first) const {
  const auto count = static_cast<std::uint64_t>(std::popcount(directions));
  if (!has_any(first, first + count)) return 0;
  DirectionMask mine = 0;
  for (DirectionMask left = directions; left; left &= left - 1, ++first)
    if (first / block_ % part_.of == part_.number - 1) mine |= left & -left;
  return mine;
}

FrontierReader::FrontierReader(const Section& grid, Part part)
    : grid_(grid),
      neighbourhood_(grid.header.spec.box),
      partition_(grid.conversions(), part),
      reader_(grid) {}

bool FrontierReader::next_chunk() {
  const std::vector<ChunkInfo>& chunks = grid_.footer.chunks;
  for (; chunk_ < chunks.size(); ++chunk_) {
    const std::uint64_t end = passed_ + chunks[chunk_].conversions;
    if (partition_.has_any(passed_, end)) {
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
      const DirectionMask todo = partition_.mine(inside, passed_);
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
