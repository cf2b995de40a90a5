// The numbers that a play can be told: what each of them means, its unit, default and bounds stand
// in one table. It drives the parsing of --set and of the table [play] of --config, and the help.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libcore/device/pid.hpp"
#include "libcore/haptic/mapping.hpp"
#include "libcore/haptic/safety.hpp"
#include "tools/common/command_line.hpp"

namespace hapgrid {

struct PlaySettings {
  SafetyLimits safety;
  MappingOptions mapping;
  PidParameters pid;
  double key_step = 0;  ///< model's units; 0: half of the grid's spacing
  double spin_us = 0;   ///< see Pacer
  double imd_wait_s = 0;
};

/// One row of the table: one number, or several that belong together.
struct Setting {
  const char* name;  ///< a key of --set; or an option, which begins with "--"
  const char* unit;
  double low, high;  ///< bounds of each number
  const char* meaning;
  std::span<double> (*values)(PlaySettings&);
};

/// The settings that somebody gave; the others keep their defaults, or what a replay recorded.
using GivenSettings = std::vector<std::pair<const Setting*, std::vector<double>>>;

/// `settings` with what was given.
PlaySettings changed(PlaySettings settings, const GivenSettings& given);

/// Adds the options --gain, --max-force, --scale and --set, and reads files of --config: keys of
/// their table [play] are the names of options, and its sub-tables have the keys of --set. What the
/// command line gives comes after what a file gives, and so it counts. `given` must outlive `app`.
void add_settings(CommandLine& app, GivenSettings& given);

/// The keys of --set as a table for the help.
std::string settings_help();

}  // namespace hapgrid
