#include "tools/expand/request_output.hpp"

#include <bit>
#include <utility>

#include "libcore/search/ranges.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

RequestOutput::RequestOutput(std::string name, std::uint64_t ranges, const SectionHeader& header)
    : name_(std::move(name)), ranges_(ranges), header_(header), neighbourhood_(header.spec.box) {
  if (ranges_ == 0) one_.emplace(open(name_));
}

SectionWriter RequestOutput::open(const std::string& name) {
  files_.push_back(std::make_unique<OutputFile>(name));
  return {files_.back()->fd(), files_.back()->name(), header_};
}

void RequestOutput::commit() {
  if (one_) one_->finish();
  for (Range& range : near_)
    if (range.writer) range.writer->finish();
  for (const auto& file : files_) file->commit();
}

void RequestOutput::move_to(PointIndex point) {
  const auto reach = static_cast<std::uint64_t>(neighbourhood_.reach());
  const auto next = [this](std::uint64_t number) {
    return Range{number, point_range(header_.spec, number, ranges_).end};
  };
  if (near_.empty()) near_.push_back(next(1));
  while (near_.back().end <= point + reach && near_.back().number < ranges_)
    near_.push_back(next(near_.back().number + 1));
  while (near_.front().end + reach <= point) {
    if (near_.front().writer) near_.front().writer->finish();
    near_.pop_front();
  }
}

void RequestOutput::add_by_range(PointIndex point, Level level, DirectionMask directions,
                                 const double* rows) {
  move_to(point);
  for (DirectionMask left = directions; left; left &= left - 1) {
    const int q = std::countr_zero(left);
    const auto target = static_cast<std::uint64_t>(point + neighbourhood_.offset(q));
    std::size_t range = 0;
    while (target >= near_[range].end) ++range;
    near_[range].directions |= DirectionMask{1} << q;
  }
  for (Range& range : near_) {
    const DirectionMask here = std::exchange(range.directions, 0);
    if (!here) continue;
    if (!range.writer) range.writer.emplace(open(numbered(name_, range.number)));
    range.writer->requests(point, level, here, rows);
  }
}

}  // namespace hapgrid
