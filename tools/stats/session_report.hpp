// The figures of a session, for people and for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "libcore/session/reader.hpp"
#include "libcore/session/statistics.hpp"

namespace hapgrid {

/// The unit in which energies of a session are shown: mJ if its settings tell how many units of
/// length a metre of the hand is.
struct EnergyUnit {
  double factor = 1;  ///< of newtons times the box's unit of length
  std::string name;   ///< "mJ" or "N angstrom"
};
EnergyUnit energy_unit(const SessionHeader& header);

/// `statistics` and `energy` are of all the session's ticks, at least one.
nlohmann::ordered_json session_json(const SessionReader& session,
                                    const SessionStatistics& statistics, const HandEnergy& energy);
std::string session_text(const SessionReader& session, const SessionStatistics& statistics,
                         const HandEnergy& energy);

}  // namespace hapgrid
