#include "libcore/search/wavefront.hpp"

#include <algorithm>

namespace hapgrid {

namespace {
// Large enough to keep threads busy, small enough to keep the states reached near the caches.
constexpr std::size_t kBatchBytes = 8 << 20;
constexpr std::size_t kMaxBatch = 2048;
}  // namespace

Wavefront::Wavefront(const GridSpec& spec)
    : neighbourhood_(spec.box),
      points_(spec.box.points()),
      n_(spec.state_size),
      row_size_(spec.row_size()) {
  const std::size_t slot_bytes = sizeof(double) * kDirections * row_size_;
  batch_size_ = std::bit_floor(std::clamp<std::size_t>(kBatchBytes / slot_bytes, 1, kMaxBatch));
  batch_bits_ = static_cast<unsigned>(std::countr_zero(batch_size_));
  blocks_.resize((points_ >> kBlockBits) + 1);
}

Wavefront::Block& Wavefront::block(std::uint64_t number) {
  std::unique_ptr<Block>& block = blocks_[number];
  if (!block) {
    if (free_blocks_.empty()) {
      block = std::make_unique_for_overwrite<Block>();
    } else {
      block = std::move(free_blocks_.back());
      free_blocks_.pop_back();
    }
    std::fill(std::begin(block->arriving), std::end(block->arriving), 0);
  }
  return *block;
}

void Wavefront::add(PointIndex point, Level level, const double* state, DirectionMask todo) {
  const std::size_t index = in_batch(end_);
  if (index == 0) {
    if (batches_.empty()) oldest_ = end_;
    if (free_batches_.empty()) {
      batches_.emplace_back();
      Batch& fresh = batches_.back();
      fresh.source = std::make_unique_for_overwrite<Source[]>(batch_size_);
      fresh.state = std::make_unique_for_overwrite<double[]>(batch_size_ * n_);
      fresh.reached =
          std::make_unique_for_overwrite<double[]>(batch_size_ * kDirections * row_size_);
    } else {
      batches_.push_back(std::move(free_batches_.back()));
      free_batches_.pop_back();
    }
  }
  Batch& batch = batches_.back();
  const bool new_point = end_ == oldest_ || this->point(end_ - 1) != point;
  batch.source[index] = {point, todo, level};
  std::copy_n(state, n_, &batch.state[index * n_]);
  if (new_point) block(point >> kBlockBits).first[point & (kBlockPoints - 1)] = end_;
  for (DirectionMask left = todo; left; left &= left - 1) {
    const int q = std::countr_zero(left);
    const auto target = static_cast<std::uint64_t>(point + neighbourhood_.offset(q));
    block(target >> kBlockBits).arriving[target & (kBlockPoints - 1)] |= DirectionMask{1} << q;
  }
  ++end_;
}

void Wavefront::forget_before(std::uint64_t target) {
  const auto reach = static_cast<std::uint64_t>(neighbourhood_.reach());
  // A source is needed until its last target is drained.
  const std::uint64_t needed = target > reach ? target - reach : 0;
  while (!batches_.empty()) {
    const Slot batch_end = std::min(end_, oldest_ + batch_size_);
    // The newest batch may still be filling.
    if (batch_end == end_ && in_batch(end_) != 0 && target < points_) break;
    if (point(batch_end - 1) >= needed && target < points_) break;
    free_batches_.push_back(std::move(batches_.front()));
    batches_.erase(batches_.begin());
    oldest_ = batch_end;
  }
  const std::uint64_t last_block = target < points_ ? needed >> kBlockBits : blocks_.size();
  for (; first_block_ < last_block; ++first_block_)
    if (blocks_[first_block_]) free_blocks_.push_back(std::move(blocks_[first_block_]));
  if (target == points_) {
    // The generation is done: the next one starts at the first point again.
    drained_ = 0;
    first_block_ = 0;
    end_ = oldest_ = 0;
  }
}

}  // namespace hapgrid
