// A grid and a session as arrays of numpy.
#pragma once

#include <cstdint>
#include <string>

#include "libcore/grid/grid.hpp"
#include "libcore/session/reader.hpp"

namespace hapgrid {

/// One array with a row for each record and the fields point (3), level, generation, state (n),
/// destination (26: rows, and -1 where a direction leaves the box, or leads nowhere yet), and if
/// the grid stores them force (3), energy and shape (spheres x 3).
/// @throw std::system_error
void write_grid_array(const Grid& grid, const std::string& file);

/// One array with a row for each tick and the fields t, hip, force, sent, levels, flags,
/// lateness_us, compute_us; force is the model's, before the safety core.
/// @param count of ticks
void write_session_array(SessionReader& session, std::uint64_t count, const std::string& file);

}  // namespace hapgrid
