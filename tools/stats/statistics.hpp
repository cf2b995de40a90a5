// The figures of a grid: the row of the paper's Table 2, and the numbers that explain it.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// Counts of one grid, which may be incomplete.
struct Statistics {
  std::uint64_t points = 0;
  std::uint64_t points_reached = 0;  ///< points that have a level
  std::uint64_t records = 0;
  std::uint64_t frontier = 0;     ///< records that no expand has looked at
  std::uint32_t generation = 0;   ///< of the grid: the round that wrote it
  std::uint64_t generations = 0;  ///< the largest generation of a record + 1; 0 without records
  std::vector<std::uint64_t> levels_histogram;  ///< entry k: points that have k levels
  /// Links that can be followed there and back: both destination levels are settled and exist.
  std::uint64_t links = 0;
  std::uint64_t one_way_links = 0;  ///< those of them that do not come back to the level
  /// In-box directions of the records that are not in the frontier: Algorithm 1 evaluates C once
  /// for each.
  std::uint64_t conversions = 0;
  std::uint64_t conversions_left = 0;  ///< conversions that the frontier asks for
  std::uint64_t stored_bytes = 0;
};

/// @param stored_bytes size of the shards as they are stored, compressed
Statistics count_statistics(const Grid& grid, std::uint64_t stored_bytes);

/// The sums over the lines of `expand --cost` and `merge --cost`.
struct CostSums {
  std::uint64_t lines = 0;
  std::uint64_t conversions = 0;
  double cpu_seconds = 0;
};

/// Adds the JSON lines in `text`, each an object with at least "cpu_seconds" (a number >= 0) and
/// "conversions" (a whole number >= 0).
/// @throw Error with `name` and line number at the first line that is not.
void add_costs(CostSums& sums, const std::string& name, const std::string& text);

/// The report; "cpu_hours" and "costs" are null without `costs`, shares and averages of nothing
/// are null. Keys are only ever added.
nlohmann::ordered_json statistics_json(const GridSpec& spec, const Statistics& statistics,
                                       const CostSums* costs);

/// The same for people, with the definition of each number.
std::string statistics_text(const GridSpec& spec, const Statistics& statistics,
                            const CostSums* costs);

}  // namespace hapgrid
