// The merge filter: lines 10 to 20 of Algorithm 1 for one generation.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/model/model.hpp"
#include "libcore/search/converter.hpp"
#include "libcore/search/ranges.hpp"
#include "libcore/shard/section.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

/// What a merge starts from: sections sorted into the grid and the requests.
class MergeInput {
 public:
  /// @throw FormatError when there is no grid, one whose numbers may be off, a part of a frontier
  /// among them, or requests of another generation than the grid's.
  explicit MergeInput(const std::vector<Section>& sections);

  const std::vector<Section>& grid() const { return grid_; }
  const std::vector<Section>& requests() const { return requests_; }
  const GridSpec& spec() const { return grid_.front().header.spec; }
  std::uint32_t generation() const { return generation_; }
  /// Conversions that the grid's frontier asks for.
  std::uint64_t conversions() const { return conversions_; }
  /// @throw FormatError unless each section is all frontier or without: a layer takes the place of
  /// the frontier, and of nothing else.
  void require_layers() const;
  /// The header of the merged grid, which is plain. A grid whose frontier is empty keeps its
  /// records.
  SectionHeader merged_header() const;

 private:
  std::vector<Section> grid_;
  std::vector<Section> requests_;
  std::uint32_t generation_ = 0;
  std::uint64_t conversions_ = 0;
};

/// What a merge stored.
struct NewRecords {
  std::uint64_t points = 0;  ///< that had no level before
  std::uint64_t records = 0;
  std::uint64_t conversions = 0;  ///< that these records ask for
};

/// Where a merged grid goes. All sections are begun with merged_header(), but for the frontier's
/// content.
struct MergeOutput {
  SectionWriter& grid;  ///< all records; but see `tip`
  /// The records that this merge stores, and which are then not in `grid`: what is written there
  /// never changes again. nullptr: they are in `grid`.
  SectionWriter* tip = nullptr;
  /// With `tip`: only the records that this merge settles are written to `grid`, a layer of the
  /// grid. The grid is all its layers and the last tip.
  bool layer = false;
  SectionWriter* frontier = nullptr;  ///< the new frontier, where somebody wants it
};

/// Merges a whole generation, or the range of it whose records are wanted: each of the conversions
/// of its frontier must be among the requests. Streams: the records between three slices of the
/// grid are in memory at a time.
/// @param range as point_range() cuts them. Grid and requests must hold what lies around it
/// (ranges.hpp); what is farther away is passed over.
/// @throw FormatError when requests are missing (it counts them), contradict each other, or were
/// not asked for; Error (level limit), ModelError, std::system_error.
NewRecords merge(const MergeInput& input, PointRange range, const Model& model,
                 const MergeOutput& out, Progress& progress);

}  // namespace hapgrid
