#include "libcore/search/levels.hpp"

#include <algorithm>
#include <bit>
#include <string>
#include <type_traits>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

Levels::Levels(const GridSpec& spec, const Model& model, Load load)
    : spec_(spec),
      model_(model),
      load_(std::move(load)),
      neighbourhood_(spec.box),
      state_size_(spec.state_size),
      row_size_(spec.row_size()),
      block_points_(chunk_points(row_size_)),
      block_bits_(static_cast<unsigned>(std::countr_zero(block_points_))) {
  blocks_.resize((spec.box.points() + block_points_ - 1) >> block_bits_);
}

void Levels::touch(std::uint64_t number) {
  std::unique_ptr<Block>& block = blocks_[number];
  if (block) return;
  if (free_blocks_.empty()) {
    block = std::make_unique<Block>();
  } else {
    block = std::move(free_blocks_.back());
    free_blocks_.pop_back();
  }
  block->first.assign(block_points_, kNone);
  if (load_) load_(number);
}

void Levels::reserve(Block& block, std::size_t count) const {
  if (block.records + count <= block.capacity) return;
  // Room for one level a point is only touched as far as it is used.
  const std::size_t capacity = std::max<std::size_t>(
      {block.records + count, 2 * std::size_t{block.capacity}, block_points_});
  const auto grow = [&](auto& column, std::size_t each) {
    using Column = std::remove_reference_t<decltype(column)>;
    Column larger(new typename Column::element_type[capacity * each]);
    std::copy_n(column.get(), block.records * each, larger.get());
    column = std::move(larger);
  };
  grow(block.next, 1);
  grow(block.point, 1);
  grow(block.level, 1);
  grow(block.generation, 1);
  grow(block.numbers, row_size_);
  grow(block.links, kDirections);
  block.capacity = static_cast<std::uint32_t>(capacity);
}

void Levels::append(const RecordRows& rows) {
  for (std::size_t begin = 0; begin < rows.size();) {
    Block& here = block(rows.point[begin]);
    const auto points = rows.point.subspan(begin);
    const auto count = static_cast<std::size_t>(
        std::upper_bound(points.begin(), points.end(), points.front() | (block_points_ - 1)) -
        points.begin());
    reserve(here, count);
    const auto copy = [&](const auto& from, auto& to, std::size_t each) {
      std::copy_n(from.data() + begin * each, count * each, &to[here.records * each]);
    };
    copy(rows.point, here.point, 1);
    copy(rows.level, here.level, 1);
    copy(rows.generation, here.generation, 1);
    copy(rows.numbers, here.numbers, row_size_);
    copy(rows.links, here.links, kDirections);
    const std::uint32_t from = here.records;
    here.records += static_cast<std::uint32_t>(count);
    records_ += count;
    chain(here, from);
    begin += count;
  }
}

void Levels::chain(Block& block, std::uint32_t from) const {
  for (std::uint32_t r = from; r < block.records; ++r) {
    block.next[r] = kNone;
    const PointIndex point = block.point[r];
    std::uint32_t* last = &block.first[in_block(point)];
    Level level = 0;
    if (r > from && block.point[r - 1] == point) {
      last = &block.next[r - 1];
      level = static_cast<Level>(block.level[r - 1] + 1);
    } else {
      for (; *last != kNone; last = &block.next[*last]) ++level;
    }
    if (block.level[r] != level)
      throw FormatError(format("grid: {}: level {} where level {} was expected",
                               describe(spec_.box, point), block.level[r], level));
    *last = r;
  }
}

RecordRows Levels::view(const Block& block) const {
  RecordRows rows;
  rows.width = row_size_;
  rows.point = {block.point.get(), block.records};
  rows.level = {block.level.get(), block.records};
  rows.generation = {block.generation.get(), block.records};
  rows.numbers = {block.numbers.get(), std::size_t{block.records} * row_size_};
  rows.links = {block.links.get(), std::size_t{block.records} * kDirections};
  return rows;
}

Levels::RecordHandle Levels::find(PointIndex point, Level level) {
  RecordHandle handle;
  Block& here = block(point);
  std::uint32_t r = here.first[in_block(point)];
  for (; level > 0 && r != kNone; --level) r = here.next[r];
  if (r == kNone) return handle;
  handle.block_ = &here;
  handle.record_ = r;
  return handle;
}

std::uint32_t Levels::generation(RecordHandle handle) const {
  return handle.block_->generation[handle.record_];
}

const double* Levels::state(RecordHandle handle) const {
  return &handle.block_->numbers[std::size_t{handle.record_} * row_size_];
}

std::string Levels::source_text(RecordHandle source, int q) const {
  const Block& from = *source.block_;
  return format("{}, direction {}",
                describe(spec_.box, from.point[source.record_], from.level[source.record_]), q);
}

bool Levels::settle_other(RecordHandle source, int q, PointIndex target, const double* numbers,
                          std::uint32_t generation) {
  Level& link = source.block_->links[std::size_t{source.record_} * kDirections + unsigned(q)];
  if (link != kUnsettled)
    throw FormatError(format("requests: {}: the grid's frontier asks for no such conversion",
                             source_text(source, q)));
  Block& here = block(target);
  std::uint32_t r = here.first[in_block(target)];
  std::uint32_t last = kNone;
  Level level = 0;
  while (r != kNone) {
    const double* const known = &here.numbers[std::size_t{r} * row_size_];
    if (has_bits(known, numbers) || model_.equal(known, numbers)) {
      link = level;
      return false;
    }
    last = r;
    r = here.next[r];
    ++level;
  }
  if (level >= spec_.max_levels) fail_level_limit(target, source);
  if (!model_.equal(numbers, numbers))
    throw ModelError(
        format("model {}: its tolerance function tells a state from itself: {}, reached from {}",
               spec_.model, describe(spec_.box, target, level), source_text(source, q)));
  link = level;
  // `link` ends here: making room may move the records of its block.
  reserve(here, 1);
  r = here.records++;
  ++records_;
  (last == kNone ? here.first[in_block(target)] : here.next[last]) = r;
  here.next[r] = kNone;
  here.point[r] = target;
  here.level[r] = level;
  here.generation[r] = generation;
  std::copy_n(numbers, row_size_, &here.numbers[std::size_t{r} * row_size_]);
  Level* links = &here.links[std::size_t{r} * kDirections];
  const DirectionMask inside = neighbourhood_.inside(target);
  for (int d = 0; d < kDirections; ++d) links[d] = inside >> d & 1 ? kUnsettled : kLeavesBox;
  last_stored_ = {target, level};
  return true;
}

void Levels::fail_level_limit(PointIndex target, RecordHandle source) const {
  const Block& from = *source.block_;
  throw LevelLimit(format(
      "level limit: {} has {} levels (search.max_levels), and a state reached from {} equals none "
      "of them within the tolerance {}{}{}: the model has more states there, or its conversion is "
      "less exact than its tolerance",
      describe(spec_.box, target), spec_.max_levels,
      describe(spec_.box, from.point[source.record_], from.level[source.record_]),
      to_text(spec_.tolerance), spec_.tolerance_unit.empty() ? "" : " ", spec_.tolerance_unit));
}

void Levels::write(SectionWriter& out) const {
  for (std::uint64_t b = 0; b < blocks(); ++b)
    visit(b, [&](const RecordRows& rows, std::size_t begin, std::size_t end) {
      out.records(rows, begin, end);
    });
  out.finish();
}

void Levels::release(std::uint64_t number) {
  std::unique_ptr<Block>& block = blocks_[number];
  if (!block) return;
  records_ -= block->records;
  block->records = 0;
  free_blocks_.push_back(std::move(block));
}

}  // namespace hapgrid
