// A session in numbers, for people and for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "libcore/session/reader.hpp"
#include "libcore/session/statistics.hpp"

namespace hapgrid {

/// `statistics` are of the session's ticks or a part of them, at least one. Keys are only ever
/// added.
nlohmann::ordered_json session_json(const SessionReader& session,
                                    const SessionStatistics& statistics);
std::string session_text(const SessionReader& session, const SessionStatistics& statistics);

}  // namespace hapgrid
