// Algorithm 1 in one process: rounds of expand and merge in memory until the frontier is
// empty.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "libcore/search/converter.hpp"
#include "libcore/search/levels.hpp"
#include "libcore/shard/section.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

// What a search in one process has found so far, in a file: after an error, a kill or a power cut
// it goes on from there.
//
// The file is written only at the end of a generation, because the records of an unfinished one
// depend on which of its conversions were made.

/// The file is replaced as a whole, so the one before is there until the new one is. It is an
/// incomplete grid as rounds of expand and merge make it.
class PartialGrid {
 public:
  /// @param tell called with a line for the user, once, when the file cannot be written, which does
  /// not end the search.
  PartialGrid(std::string name, std::function<void(const std::string&)> tell);

  const std::string& name() const { return name_; }
  /// Where a search of `grid` starts: from the file, if there is one, else from the grid itself.
  /// The file's grid may have a lower level limit, which was not reached in it.
  /// @throw FormatError when the file is not what a search of this grid would have left
  Section start(const Section& grid);

  /// Writes `levels`, whose last generation is `header.generation`, unless the last write was too
  /// short a time ago.
  void write_checkpoint_if_due(const SectionHeader& header, const Levels& levels);
  /// The generation in the file, if there is one.
  std::optional<std::uint32_t> kept() const { return kept_; }

  /// The search is done.
  void remove();

 private:
  using Clock = std::chrono::steady_clock;
  void write_checkpoint(const SectionHeader& header, const Levels& levels);

  std::string name_;
  std::function<void(const std::string&)> tell_;
  bool complained_ = false;
  std::optional<std::uint32_t> kept_;
  Clock::time_point due_;
};

/// Completes a grid. `open` is called once, with the header of the finished grid, and gives the
/// writer for it. The bytes are those that rounds of expand and merge end with.
/// @param partial keeps the last whole generation in a file, and the message of an error names that
/// generation; `grid` must be what partial->start() answered. With null, nothing is kept.
/// @throw Stopped, Error (level limit), ModelError, FormatError, std::system_error
void complete(const Section& grid, Converter& converter, Progress& progress,
              const std::function<SectionWriter(const SectionHeader&)>& open,
              PartialGrid* partial = nullptr);

}  // namespace hapgrid
