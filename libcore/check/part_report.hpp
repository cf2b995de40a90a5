// What one process of many found in its part of a grid, on its way to whoever puts the parts
// together. The report of all parts is the one that a single process gives, byte for byte: that
// one is made from its one part in the same way.
//
// Checks that go through points, records or walks are shared out in contiguous ranges, so that
// joining them in order joins their findings. What belongs to the whole grid (`reachable`,
// `generations`, `precision`, and all that follows from the configurations) is in the first part
// alone. Of the walks each part keeps every error: a median is no sum.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libcore/check/accuracy.hpp"
#include "libcore/check/range.hpp"
#include "libcore/check/report.hpp"

namespace hapgrid {

struct PartReport {
  CheckPart part;
  std::string digest;  ///< of the grid's content
  GridSummary grid;
  /// By name what else the report depends on: numbers and texts.
  nlohmann::ordered_json options = nlohmann::ordered_json::object();
  std::vector<Check> checks;  ///< rows of which the part has a share
  /// Where walks were asked for.
  std::optional<AccuracyTerms> terms{};
  Walked walked{};
};

/// The rows of all parts together, the one of the walks last.
/// @param names of the parts, for messages; as many.
/// @throw Error when a part is missing or doubled, or of another grid or with other options than
/// the first one named.
std::vector<Check> join(std::vector<PartReport> parts, const std::vector<std::string>& names);

/// As JSON, and back to the bit.
std::string part_to_json(const PartReport& part);
/// @param name for messages. @throw Error when it is no such report.
PartReport part_from_json(const std::string& text, const std::string& name);

}  // namespace hapgrid
