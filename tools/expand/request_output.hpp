// Where the requests of an expand go.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

/// The requests of a run, in one shard, or in one for each range of their targets that has some.
class RequestOutput {
 public:
  /// @param name of the shard; with `ranges` > 0 the {} in it becomes the range's number, from 1.
  RequestOutput(std::string name, std::uint64_t ranges, const SectionHeader& header);

  /// Ascending by target. @throw std::system_error, as all here
  void add(PointIndex target, int q, Level level, const double* row) {
    if (ranges_ > 0 && target >= end_) next_range(target);
    writer_->request(target, q, level, row);
  }

  /// All shards appear, in the order of their ranges.
  void commit();

 private:
  void open(const std::string& name);
  /// Goes on in the shard of the range that holds `target`; those in between get none.
  void next_range(PointIndex target);

  std::string name_;
  std::uint64_t ranges_;
  SectionHeader header_;
  std::vector<std::unique_ptr<OutputFile>> files_;
  std::optional<SectionWriter> writer_;
  std::uint64_t range_ = 0;
  std::uint64_t end_ = 0;  // of the range at hand
};

}  // namespace hapgrid
