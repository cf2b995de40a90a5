#include "libcore/search/levels.hpp"

#include <algorithm>
#include <utility>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/shard/reader.hpp"

namespace hapgrid {

namespace {

/// Where a column grows, it is in memory twice for a moment. So there is room from the start for
/// what most grids have in the end, which takes memory only as far as it is used. What a header
/// alone can claim is limited.
std::size_t room_for(const GridSpec& spec) {
  constexpr std::uint64_t kBytes = 1 << 30;
  return std::min(spec.box.points() + spec.box.points() / 2,
                  kBytes / record_bytes(spec.row_size()));
}

}  // namespace

Levels::Levels(const Section& grid, const Model& model)
    : spec_(grid.header.spec),
      model_(model),
      neighbourhood_(spec_.box),
      state_size_(spec_.state_size),
      row_size_(spec_.row_size()) {
  require_possible(spec_.box, grid.records());
  first_.resize(spec_.box.points(), kNone);
  const std::size_t room = room_for(spec_);
  columns_.point.reserve(room);
  columns_.level.reserve(room);
  columns_.generation.reserve(room);
  columns_.rows.reserve(room * row_size_);
  columns_.links.reserve(room * kDirections);
  next_.reserve(room);
  SectionReader reader(grid);
  Chunk rows;
  for (std::size_t i = 0; i < grid.chunks.size(); ++i) {
    reader.read(i, rows);
    append(rows);
  }
}

void Levels::append(const Chunk& rows) {
  const auto add = [](auto& column, const auto& more) {
    column.insert(column.end(), more.begin(), more.end());
  };
  const RecordIndex from = records();
  add(columns_.point, rows.point);
  add(columns_.level, rows.level);
  add(columns_.generation, rows.generation);
  add(columns_.rows, rows.numbers);
  add(columns_.links, rows.links);
  next_.resize(columns_.size(), kNone);
  for (RecordIndex r = from; r < records(); ++r) {
    // Points ascend, also from chunk to chunk.
    const bool is_first = r == 0 || point(r - 1) != point(r);
    const unsigned expected = is_first ? 0 : level(r - 1) + 1U;
    if (level(r) != expected)
      throw FormatError(format("grid: {}: level {} where level {} was expected",
                               describe(spec_.box, point(r)), level(r), expected));
    (is_first ? first_[point(r)] : next_[r - 1]) = r;
  }
}

RecordIndex Levels::find(PointIndex point, Level level) const {
  RecordIndex r = first_[point];
  for (; level > 0 && r != kNone; --level) r = next_[r];
  return r;
}

std::string Levels::record_text(RecordIndex r) const {
  return describe(spec_.box, point(r), level(r));
}

void Levels::settle_other(RecordIndex source, int q, PointIndex target, const double* numbers,
                          std::uint32_t generation) {
  if (link(source, q) != kUnsettled)
    throw FormatError(
        format("requests: {}, direction {}: the grid's frontier asks for no such conversion",
               record_text(source), q));
  RecordIndex last = kNone;
  Level level = 0;
  for (RecordIndex r = first_[target]; r != kNone; r = next_[r], ++level) {
    if (has_bits(state(r), numbers) || model_.equal(state(r), numbers)) {
      link(source, q) = level;
      return;
    }
    last = r;
  }
  if (level >= spec_.max_levels) fail_level_limit(target, source);
  if (!model_.equal(numbers, numbers))
    throw ModelError(
        format("model {}: its tolerance function tells a state from itself: {}, reached from {}, "
               "direction {}",
               spec_.model, describe(spec_.box, target, level), record_text(source), q));
  link(source, q) = level;
  const RecordIndex r = records();
  require_possible(spec_.box, std::uint64_t{r} + 1);
  (last == kNone ? first_[target] : next_[last]) = r;
  next_.push_back(kNone);
  columns_.point.push_back(target);
  columns_.level.push_back(level);
  columns_.generation.push_back(generation);
  columns_.rows.insert(columns_.rows.end(), numbers, numbers + row_size_);
  const DirectionMask inside = neighbourhood_.inside(target);
  for (int d = 0; d < kDirections; ++d)
    columns_.links.push_back(inside >> d & 1 ? kUnsettled : kLeavesBox);
}

void Levels::fail_level_limit(PointIndex target, RecordIndex source) const {
  throw LevelLimit(format(
      "level limit: {} has {} levels (search.max_levels), and a state reached from {} equals none "
      "of them within the tolerance {}{}{}: the model has more states there, its conversion is "
      "less "
      "exact than its tolerance, or a body turns or slides freely, since nothing holds it",
      describe(spec_.box, target), spec_.max_levels, record_text(source), to_text(spec_.tolerance),
      spec_.tolerance_unit.empty() ? "" : " ", spec_.tolerance_unit));
}

void Levels::require_settled(std::uint32_t generation) const {
  std::uint64_t asked = 0;    // conversions that must be settled
  std::uint64_t missing = 0;  // of these, not settled
  std::string first_missing;
  for_each([&](RecordIndex r) {
    if (columns_.generation[r] != generation) return;
    asked += static_cast<std::uint64_t>(std::popcount(neighbourhood_.inside(point(r))));
    const Level* const links = &columns_.links[std::size_t{r} * kDirections];
    const auto left = std::count(links, links + kDirections, kUnsettled);
    if (left > 0 && missing == 0) first_missing = record_text(r);
    missing += static_cast<std::uint64_t>(left);
  });
  if (missing == 0) return;
  throw FormatError(format(
      "requests are missing: {} of the {} conversions of generation {}, the first from {}; was a "
      "shard lost, or is one still to be expanded?",
      missing, asked, generation, first_missing));
}

void Levels::write(SectionWriter& out) const {
  RecordIndex begin = 0;  // of a run of records
  RecordIndex end = 0;
  for_each([&](RecordIndex r) {
    if (r != end) {
      out.records(columns_, begin, end);
      begin = r;
    }
    end = r + 1;
  });
  out.records(columns_, begin, end);
  out.finish();
}

}  // namespace hapgrid
