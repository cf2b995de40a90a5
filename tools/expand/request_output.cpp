#include "tools/expand/request_output.hpp"

#include <utility>

#include "libcore/search/ranges.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

RequestOutput::RequestOutput(std::string name, std::uint64_t ranges, const SectionHeader& header)
    : name_(std::move(name)), ranges_(ranges), header_(header) {
  if (ranges_ == 0) open(name_);
}

void RequestOutput::commit() {
  if (writer_) writer_->finish();
  for (const auto& file : files_) file->commit();
}

void RequestOutput::open(const std::string& name) {
  files_.push_back(std::make_unique<OutputFile>(name));
  writer_.emplace(files_.back()->fd(), files_.back()->name(), header_);
}

void RequestOutput::next_range(PointIndex target) {
  while (target >= end_) end_ = point_range(header_.spec, ++range_, ranges_).end;
  if (writer_) writer_->finish();
  open(numbered(name_, range_));
}

}  // namespace hapgrid
