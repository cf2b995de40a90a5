#include "libcore/search/frontier.hpp"

#include <algorithm>
#include <bit>
#include <functional>
#include <numeric>
#include <queue>
#include <string>
#include <utility>

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
      deal_(grid.conversions(), part),
      conversions_(deal_.conversions()),
      reader_(grid) {
  const std::vector<ChunkInfo>& chunks = grid.footer.chunks;
  const auto asking = std::count_if(chunks.begin(), chunks.end(),
                                    [](const ChunkInfo& chunk) { return chunk.conversions > 0; });
  if (static_cast<std::uint64_t>(asking) / kManyChunks >= part.of) deal_chunks(part);
}

void FrontierReader::deal_chunks(Part part) {
  const std::vector<ChunkInfo>& chunks = grid_.footer.chunks;
  std::vector<std::size_t> order(chunks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return chunks[a].conversions > chunks[b].conversions;
  });
  using Load = std::pair<std::uint64_t, std::uint64_t>;  // conversions of a part, its number
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (std::uint64_t number = 1; number <= part.of; ++number) loads.emplace(0, number);
  own_chunks_.resize(chunks.size());
  conversions_ = 0;
  for (const std::size_t i : order) {
    const auto [load, number] = loads.top();
    loads.pop();
    loads.emplace(load + chunks[i].conversions, number);
    if (number != part.number || chunks[i].conversions == 0) continue;
    own_chunks_[i] = true;
    conversions_ += chunks[i].conversions;
  }
}

bool FrontierReader::next_chunk() {
  const std::vector<ChunkInfo>& chunks = grid_.footer.chunks;
  for (; chunk_ < chunks.size(); ++chunk_) {
    const std::uint64_t end = passed_ + chunks[chunk_].conversions;
    if (own_chunks_.empty() ? deal_.has_any(passed_, end) : own_chunks_[chunk_]) {
      reader_.read(chunk_++, rows_);
      row_ = 0;
      return true;
    }
    passed_ = end;
  }
  return false;
}

bool FrontierReader::next(Record& record) {
  for (;;) {
    for (; row_ < rows_.size(); ++row_) {
      if (rows_.generation[row_] != grid_.header.generation) continue;
      const PointIndex point = rows_.point[row_];
      const DirectionMask inside = neighbourhood_.inside(point);
      const DirectionMask todo = own_chunks_.empty() ? deal_.own(inside, passed_) : inside;
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
