// All that verify looks at.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "libcore/check/played_work.hpp"
#include "libcore/check/report.hpp"
#include "libcore/check/steep.hpp"
#include "libcore/shard/section.hpp"
#include "tools/common/force_rules.hpp"
#include "tools/common/models.hpp"
#include "tools/common/traversals.hpp"

namespace hapgrid {

struct Examination {
  std::uint64_t recompute = 1000;  ///< records; ~0: all
  std::uint64_t sample_seed = 1;
  std::uint64_t walks = 0;
  std::optional<double> accuracy;
  TraversalRule traversal = kDefaultRule;
  std::optional<ForceRule> force;  ///< nothing: the default of play
  ForceLimit limit;
  /// Newtons that a closed walk of the played force may gain a unit of length.
  std::optional<double> friction;
  int threads = 1;
  Rendering rendering;
  ModelOptions model;
};

/// The rows of the report.
/// @throw what models throw.
std::vector<Check> examine(const Grid& grid, const Examination& asked);
/// The first of them, down to `generations`, in memory that does not grow with the grid
/// (check/invariants.hpp). @throw also as load_grid()
std::vector<Check> examine_invariants(const Section& section, const ModelOptions& model);

}  // namespace hapgrid
