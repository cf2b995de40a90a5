// All that verify looks at, in one part of the grid or in all of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libcore/check/part_report.hpp"
#include "libcore/check/range.hpp"
#include "libcore/check/steep.hpp"
#include "tools/common/models.hpp"

namespace hapgrid {

struct Examination {
  std::string grid;
  std::uint64_t recompute = 1000;  ///< records; ~0: all
  std::uint64_t sample_seed = 1;
  std::uint64_t walks = 0;
  std::optional<double> accuracy;
  int threads = 1;
  Rendering rendering;
  ModelOptions model;
  CheckPart part;
};

/// @throw what load_grid() and models throw.
PartReport examine(const Examination& asked);

}  // namespace hapgrid
