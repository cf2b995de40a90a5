#include "libcore/grid/record_window.hpp"

#include <algorithm>
#include <bit>

namespace hapgrid {

namespace {
/// How far a neighbour in the box can be, as a difference of point indices.
std::uint64_t reach_inside(const Box& box) {
  const std::uint64_t nx = box.counts[0], ny = box.counts[1];
  return 1 + (ny > 1 || box.counts[2] > 1 ? nx : 0) + (box.counts[2] > 1 ? nx * ny : 0);
}
}  // namespace

RecordWindow::RecordWindow(const GridSpec& spec)
    : around_(spec.box),
      points_(spec.box.points()),
      reach_(reach_inside(spec.box)),
      order_(spec),
      inside_of_(spec.box, around_),
      entries_(std::bit_ceil(2 * reach_ + 3)),
      mask_(entries_.size() - 1) {
  const std::int64_t row = spec.box.counts[0];
  const std::int64_t layer = row * spec.box.counts[1];
  std::size_t i = 0;
  for (std::int64_t k = -1; k <= 1; ++k)
    for (std::int64_t j = -1; j <= 1; ++j) rows_[i++] = k * layer + j * row;
}

/// Begins the next point, without a record so far.
void RecordWindow::open() { at(opened_++) = {records_, 0, 0}; }

void RecordWindow::append(PointIndex p, Level level, std::uint32_t generation, const Level* links) {
  if (records_ == Grid::kNoRecord - 1) throw FormatError("grid: more than 4294967294 records");
  const DirectionMask inside = inside_of_(p);
  if (records_ == 0 || inside != inside_before_ ||
      !std::equal(links, links + kDirections, links_before_.begin())) {
    std::copy_n(links, kDirections, links_before_.begin());
    inside_before_ = inside;
    number_before_ = table_.add(make_links(links, nullptr, inside));
  }
  kept_.push_back({number_before_, generation});
  ++records_;
  Entry& entry = at(p);
  ++entry.levels;
  const bool is_plain =
      level == 0 && table_[number_before_].usable == inside &&
      std::all_of(links, links + kDirections, [](Level to) { return to == 0 || to == kLeavesBox; });
  entry.run = is_plain && p > 0 ? static_cast<std::uint16_t>(std::min(at(p - 1).run + 1, 3))
                                : static_cast<std::uint16_t>(is_plain);
}

}  // namespace hapgrid
