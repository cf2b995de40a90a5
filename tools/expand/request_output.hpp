// Where the requests of an expand go.
#pragma once

#include <cstdint>
#include <deque>
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

  /// As SectionWriter::requests(). @throw std::system_error, as all here
  void add(PointIndex point, Level level, DirectionMask directions, const double* rows) {
    if (ranges_ > 0)
      add_by_range(point, level, directions, rows);
    else
      one_->requests(point, level, directions, rows);
  }

  /// All shards appear, in the order of their ranges.
  void commit();

 private:
  /// A range that targets at hand lie in. Without any so far, it has no shard.
  struct Range {
    std::uint64_t number;
    std::uint64_t end;
    DirectionMask directions = 0;  // of the record at hand
    std::optional<SectionWriter> writer = std::nullopt;
  };

  void add_by_range(PointIndex point, Level level, DirectionMask directions, const double* rows);
  SectionWriter open(const std::string& name);
  /// Keeps those that targets within reach of `point` lie in.
  void move_to(PointIndex point);

  std::string name_;
  std::uint64_t ranges_;
  SectionHeader header_;
  Neighbourhood neighbourhood_;
  std::vector<std::unique_ptr<OutputFile>> files_;
  std::optional<SectionWriter> one_;  // where there are no ranges
  std::deque<Range> near_;
};

}  // namespace hapgrid
