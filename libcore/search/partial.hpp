// What a search in one process has found so far, in a file: after an error, a kill or a power cut
// it goes on from there.
//
// Only whole generations are kept, because the records of a half one depend on how far each of its
// conversions came. Since a record of the generation before is complete but for the links of its
// frontier, the last whole generation can be written at any time during the next one.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "libcore/grid/grid.hpp"
#include "libcore/search/levels.hpp"
#include "libcore/shard/section.hpp"

namespace hapgrid {

/// The file is written beside and renamed, so the one before is there until the new one is. It is
/// an incomplete grid as rounds of expand and merge make it.
class PartialGrid {
 public:
  /// @param seconds the shortest time between two writes. A write that takes long makes it longer:
  /// no more than 3 % of the time is spent on them.
  /// @param tell called with a line for the user: once that there is a file, and once that it
  /// cannot be written, which does not end the search.
  PartialGrid(std::string name, double seconds, std::function<void(const std::string&)> tell);

  const std::string& name() const { return name_; }
  /// Where a search of `grid` starts: from the file, if there is one, else from the grid itself.
  /// The file's grid may have a lower level limit, which was not reached in it.
  /// @throw FormatError when the file is not what a search of this grid would have left
  Section start(const Section& grid);

  /// Keeps generation `header.generation` of `levels`, which may have records of the next one,
  /// unless it is kept already or the last write was too short a time ago.
  void keep_if_due(const SectionHeader& header, const Levels& levels);

  /// For an error: keeps what is not kept yet, if it can.
  void keep(const SectionHeader& header, const Levels& levels) noexcept;
  void keep(const Grid& grid) noexcept;
  /// The generation in the file, if there is one.
  std::optional<std::uint32_t> kept() const { return kept_; }

  /// The search is done.
  void remove();

 private:
  using Clock = std::chrono::steady_clock;
  template <class Visit>
  void write(const SectionHeader& header, Visit&& visit);
  void write(const SectionHeader& header, const Levels& levels);

  std::string name_;
  std::chrono::duration<double> least_;
  std::function<void(const std::string&)> tell_;
  bool complained_ = false;
  std::uint32_t known_ = 0;  // the generation that needs no write
  std::optional<std::uint32_t> kept_;
  Clock::time_point due_;
};

}  // namespace hapgrid
