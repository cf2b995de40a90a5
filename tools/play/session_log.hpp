// The compact log of a play (libcore/session): what is in it, and what a replay takes from it.
#pragma once

#include <optional>
#include <string>

#include "libcore/loop/loop.hpp"
#include "libcore/session/recorder.hpp"
#include "libcore/session/recording.hpp"
#include "tools/common/traversals.hpp"

namespace hapgrid {

/// Whether --log FILE is a session, FILE.session; any other name is a text.
bool is_session_name(const std::string& file);

/// What forces depend on beside the grid. A replay takes it from the session, so it has the same
/// forces, except where a thread asked the model.
struct PlayedWith {
  SafetyLimits limits;  ///< as they were applied, with the device's own limit
  double scale = 0;     ///< Mapping::scale()
  TraversalRule traversal = kDefaultRule;
  std::string beside;  ///< is_beside()
};

/// The header of a session. @param digest of the grid.
SessionHeader session_header(const GridSpec& spec, const std::string& digest, double rate_hz,
                             const PlayedWith& with);
/// What a session was played with. @throw Error when its settings are not play's.
PlayedWith played_with(const SessionHeader& header, const std::string& name);

/// Real-time safe.
TickRecord tick_record(const Tick& tick) noexcept;

}  // namespace hapgrid
