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
  double damping = 2, rate_hz = 1000;  ///< of the device, see check_steep()
  std::optional<double> scale{};       ///< model's units of length for a metre of the hand
  ModelOptions model;
};

/// The rows of the report.
/// @throw what models throw.
std::vector<Check> examine(const Grid& grid, const Examination& asked);

}  // namespace hapgrid
