// A grid, a session and frames as arrays of numpy.
#pragma once

#include <cstdint>
#include <string>

#include "libcore/grid/grid.hpp"
#include "libcore/scene/stream.hpp"
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

/// One array with a row for each frame and the fields t, tick, hip, position, sent, energy, state
/// (n), shape (spheres x 3), radius (spheres), jumps, own_energy, hand (NaN without one). Play may
/// have been stopped in the middle of a frame, which is left out then.
/// @throw std::system_error; FormatError where a frame is damaged
void write_frames_array(SceneReader frames, const std::string& file);

}  // namespace hapgrid
