// The merge filter: lines 10 to 20 of Algorithm 1 for one generation.
#pragma once

#include <string>
#include <vector>

#include "libcore/model/model.hpp"
#include "libcore/search/converter.hpp"
#include "libcore/shard/section.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

/// What a merge starts from.
struct MergeInput {
  Section grid;
  std::vector<Section> requests;

  /// The header of the merged grid. A grid whose frontier is empty keeps its generation.
  SectionHeader merged_header() const;
};

/// Sorts sections into the grid and the requests.
/// @throw FormatError unless there is one grid, and all the others are of its generation.
MergeInput merge_input(std::vector<Section> sections);

/// Merges a whole round: each of the conversions of the grid's frontier must be among the requests;
/// when it has no frontier, it is copied. Memory: the whole grid, and a chunk of each section of
/// requests. Writes to `fd`, which the caller keeps open, and nothing before all requests are
/// settled; `name` is for messages.
/// @throw FormatError when requests are missing (it counts them), contradict each other, or were
/// not asked for; Error (level limit), ModelError, std::system_error.
void merge(const MergeInput& input, const Model& model, int fd, const std::string& name,
           Progress& progress);

/// Writes the records of a finished grid to `out`, which cuts them into its own chunks, and
/// finishes it. @throw Error when the frontier is not empty; FormatError, std::system_error
void copy_finished(const Section& grid, SectionWriter& out);

}  // namespace hapgrid
