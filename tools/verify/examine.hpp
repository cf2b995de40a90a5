// All that verify looks at.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "libcore/check/report.hpp"
#include "tools/common/models.hpp"

namespace hapgrid {

struct Examination {
  std::uint64_t recompute = 1000;  ///< records; ~0: all
  std::uint64_t walks = 0;
  std::optional<double> accuracy;
  int threads = 1;
  ModelOptions model;
};

/// The rows of the report.
/// @throw what models throw.
std::vector<Check> examine(const Grid& grid, const Examination& asked);

}  // namespace hapgrid
