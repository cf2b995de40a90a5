// A grid and a session as arrays, for numpy.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libcore/grid/grid.hpp"
#include "libcore/session/reader.hpp"

namespace hapgrid {

/// By record: point (n x 3), level, generation, state (n x m), destination (n x 26: records, and -1
/// where a direction leaves the box, or leads nowhere yet), and if the grid stores them force
/// (n x 3), energy, shape (n x spheres x 3) and tear (n x 26: the interval in which the branch
/// ends, 255 elsewhere); origin, spacing and counts of the box.
/// @throw std::system_error
void write_grid_arrays(const Grid& grid, const std::string& file);

/// One array `ticks` with the fields t, hip, force, sent, levels, flags, lateness_us, compute_us,
/// as session/text.hpp has them.
/// @param count of ticks @param each calls its argument for each of them
void write_session_arrays(
    const SessionHeader& header, std::uint64_t count,
    const std::function<void(const std::function<void(const TickRecord&)>&)>& each,
    const std::string& file);

}  // namespace hapgrid
