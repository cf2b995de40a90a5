// What makes two shards parts of the same grid: the description that each header carries.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "libcore/grid/box.hpp"

namespace hapgrid {

/// The value of a model's parameter, as it stands in [model.parameters] of a MODEL.toml.
/// Whole numbers are kept as doubles (a MODEL.toml with one beyond 2^53 is refused).
using ParameterValue =
    std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>>;

struct Parameter {
  std::string key;  ///< tables are flattened: "probe.radius"
  ParameterValue value;
  friend bool operator==(const Parameter&, const Parameter&) = default;
};

/// The largest state size: 2^20 doubles are 8 MiB; more is a mistake or an attack.
inline constexpr std::uint32_t kMaxStateSize = 1u << 20;

/// Everything about a grid that is known before its first record is computed.
struct GridSpec {
  Box box;
  std::string model;                  ///< the plug-in's plain name
  std::vector<Parameter> parameters;  ///< ascending by key
  std::uint32_t state_size = 1;       ///< n, the number of components of a state
  double tolerance = 0;               ///< the bound that the model's tolerance function applies
  std::string tolerance_unit;
  std::uint32_t max_levels = 8;  ///< level limit: levels a point may have, 1 .. kMaxLevels

  friend bool operator==(const GridSpec&, const GridSpec&) = default;
};

/// Says in words what differs first between two descriptions, empty when nothing does:
/// "spacing 0.05 and 0.1".
std::string difference(const GridSpec& a, const GridSpec& b);

}  // namespace hapgrid
