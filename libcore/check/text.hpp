// Numbers, states and links as reports and dumps write them: the same in every locale.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// `value` with `decimals` digits after the point ("1.023").
std::string fixed(double value, int decimals);

/// `value` with at most six significant digits, for people ("0.025", "1e-06").
std::string rounded(double value);

/// Strings from shards are hostile: everything but printable ASCII becomes '?'.
std::string printable(std::string_view text);

/// A state for people: "0.1", or "(0.1, 0.2, 0.3, ...)" with at most four components.
std::string state_text(std::span<const double> state);

/// "point 5 (1, 2, 0) level 1"
std::string describe(const Grid& grid, RecordIndex r);
/// "point 5 (1, 2, 0) level 1 direction 3 (-1, 0, -1)"
std::string describe_link(const Grid& grid, RecordIndex r, int q);

}  // namespace hapgrid
