// A grid as text, for eyes and for scripts.
#pragma once

#include <string>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// The names of the columns in a line: "# i j k level s0 ... d0 ... d25", separated by tabs.
std::string dump_header(const Grid& grid);

/// Appends record r as one line: i j k level state... and the 26 destination levels, q ascending,
/// separated by tabs. A destination level is '-' where the direction leaves the box and '?' where
/// it is not settled; states have 17 significant digits, in every locale.
/// Source: design.md, section 4.
void append_record(std::string& text, const Grid& grid, RecordIndex r);

}  // namespace hapgrid
