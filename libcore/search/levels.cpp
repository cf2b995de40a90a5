#include "libcore/search/levels.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/shard/format.hpp"

namespace hapgrid {

Levels::Levels(const GridSpec& spec, const Model& model)
    : spec_(spec),
      model_(model),
      neighbourhood_(spec.box),
      row_size_(spec.row_size()),
      block_points_(chunk_points(row_size_)),
      block_bits_(static_cast<unsigned>(std::countr_zero(block_points_))),
      stride_(row_size_ + (sizeof(Tail) + sizeof(double) - 1) / sizeof(double)),
      last_row_(row_size_) {
  blocks_.resize((spec.box.points() + block_points_ - 1) >> block_bits_);
}

Levels::Block& Levels::block(PointIndex point) {
  std::unique_ptr<Block>& block = blocks_[point >> block_bits_];
  if (!block) {
    if (free_blocks_.empty()) {
      block = std::make_unique<Block>();
    } else {
      block = std::move(free_blocks_.back());
      free_blocks_.pop_back();
    }
    block->first.assign(block_points_, kNone);
  }
  return *block;
}

std::uint32_t Levels::add(Block& block, const double* numbers, std::uint32_t generation) {
  const std::uint32_t r = block.records++;
  if (block.records > block.capacity) {
    // Room for one level a point is only touched as far as it is used.
    const std::uint32_t capacity = std::max(2 * block.capacity, block_points_);
    auto rows = std::make_unique_for_overwrite<double[]>(capacity * stride_);
    std::copy_n(block.rows.get(), block.capacity * stride_, rows.get());
    block.rows = std::move(rows);
    block.capacity = capacity;
  }
  double* here = row(block, r);
  std::copy_n(numbers, row_size_, here);
  Tail& t = tail(here);
  t.next = kNone;
  t.generation = generation;
  ++records_;
  return r;
}

const double* Levels::find(PointIndex point, Level level) const {
  const Block* block = find_block(point);
  if (!block) return nullptr;
  std::uint32_t r = block->first[in_block(point)];
  for (; level > 0 && r != kNone; --level) r = tail(row(*block, r)).next;
  return r == kNone ? nullptr : row(*block, r);
}

const double* Levels::state(PointIndex point, Level level) const { return find(point, level); }

DirectionMask Levels::unsettled(PointIndex point, Level level) const {
  DirectionMask mask = 0;
  const Tail& t = tail(find(point, level));
  for (int q = 0; q < kDirections; ++q)
    if (t.links[q] == kUnsettled) mask |= DirectionMask{1} << q;
  return mask;
}

void Levels::append(PointIndex point, Level level, std::uint32_t generation, const double* numbers,
                    const Level* links) {
  Block& here = block(point);
  std::uint32_t* slot = &here.first[in_block(point)];
  Level next = 0;
  std::uint32_t last = kNone;
  for (std::uint32_t r = *slot; r != kNone; r = tail(row(here, r)).next) {
    last = r;
    ++next;
  }
  if (level != next)
    throw FormatError("grid: " + describe(spec_.box, point) + ": level " + std::to_string(level) +
                      " where level " + std::to_string(next) + " was expected");
  const std::uint32_t r = add(here, numbers, generation);
  std::copy_n(links, kDirections, tail(row(here, r)).links);
  (last == kNone ? *slot : tail(row(here, last)).next) = r;
}

bool Levels::settle(PointIndex target, int q, Level source_level, const double* numbers,
                    std::uint32_t generation) {
  const auto source = static_cast<PointIndex>(std::int64_t{target} - neighbourhood_.offset(q));
  auto* from = const_cast<double*>(find(source, source_level));
  Level* link = from ? &tail(from).links[q] : nullptr;
  if (!link || *link != kUnsettled) {
    const bool repeated =
        link && target == last_target_ && q == last_q_ && source_level == last_source_level_;
    if (repeated && std::memcmp(numbers, last_row_.data(), row_size_ * sizeof(double)) == 0)
      return false;
    throw FormatError("requests: " + describe(spec_.box, source, source_level) + ", direction " +
                      std::to_string(q) +
                      (repeated ? ": two different answers"
                                : ": the grid's frontier asks for no such conversion"));
  }
  last_target_ = target;
  last_q_ = q;
  last_source_level_ = source_level;
  std::copy_n(numbers, row_size_, last_row_.data());

  Block& here = block(target);
  std::uint32_t r = here.first[in_block(target)];
  std::uint32_t last = kNone;
  Level level = 0;
  while (r != kNone) {
    const double* known = row(here, r);
    if (model_.equal(known, numbers)) {
      *link = level;
      return false;
    }
    last = r;
    r = tail(known).next;
    ++level;
  }
  if (level >= spec_.max_levels) fail_level_limit(target, q, source_level);
  if (!model_.equal(numbers, numbers))
    throw ModelError(
        "model " + spec_.model + ": its tolerance function tells a state from itself: " +
        describe(spec_.box, target, level) + ", reached from " +
        describe(spec_.box, source, source_level) + ", direction " + std::to_string(q));
  *link = level;
  // `link` ends here: adding a record may move the rows of its block.
  r = add(here, numbers, generation);
  (last == kNone ? here.first[in_block(target)] : tail(row(here, last)).next) = r;
  Tail& t = tail(row(here, r));
  const DirectionMask inside = neighbourhood_.inside(target);
  for (int d = 0; d < kDirections; ++d) t.links[d] = inside >> d & 1 ? kUnsettled : kLeavesBox;
  last_stored_ = {target, level};
  return true;
}

void Levels::fail_level_limit(PointIndex target, int q, Level source_level) const {
  const auto source = static_cast<PointIndex>(std::int64_t{target} - neighbourhood_.offset(q));
  throw Error(
      "level limit: " + describe(spec_.box, target) + " has " + std::to_string(spec_.max_levels) +
      " levels (search.max_levels), and a state reached from " +
      describe(spec_.box, source, source_level) + " equals none of them within the tolerance " +
      to_text(spec_.tolerance) + (spec_.tolerance_unit.empty() ? "" : " " + spec_.tolerance_unit) +
      ": the model has more states there, or its conversion is less exact than its tolerance");
}

void Levels::release(std::uint64_t number) {
  std::unique_ptr<Block>& block = blocks_[number];
  if (!block) return;
  records_ -= block->records;
  block->records = 0;
  free_blocks_.push_back(std::move(block));
}

}  // namespace hapgrid
