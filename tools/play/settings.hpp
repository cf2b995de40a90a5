// The numbers that a play can be told: what each of them means, its unit, default and bounds stand
// in one table. It drives the parsing of the table [play] of --config, and the help.
//
// A file with other tables, such as a definition, may be a stranger's: it maps the hand to the
// model, and makes limits stricter. A file that has the table [play] alone is the user's own, and
// sets everything here but a gain or force above the defaults. Nothing else is taken from either,
// least of all where plug-ins and outputs are.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libcore/loop/mapping.hpp"
#include "libcore/loop/safety.hpp"
#include "tools/common/command_line.hpp"

namespace hapgrid {

/// What the adapter hapgrid-evdev is told.
struct EvdevSettings {
  double newtons = 2;                 ///< of the strongest effect
  double half_range = 0.05;           ///< metres from the middle of a held axis to its end
  std::array<double, 2> signs{1, 1};  ///< of x and y
};

struct PlaySettings {
  SafetyLimits safety;
  MappingOptions mapping;
  EvdevSettings evdev;
  double spin_us = 0;  ///< see Pacer
};

/// Whether a file that may be a stranger's sets a number. For options this holds for each file.
enum class FromFile {
  kNo,
  kFree,    ///< as the command line
  kLower,   ///< to the default at most
  kHigher,  ///< to the default at least: a larger number is the more careful one
};

/// One row of the table: one number, or several that belong together.
struct Setting {
  const char* name;  ///< a key of the table; or an option, which begins with "--"
  const char* unit;
  double low, high;  ///< bounds of each number
  FromFile from_file;
  const char* meaning;
  std::span<double> (*values)(PlaySettings&);
};

/// The settings that somebody gave; the others keep their defaults, or what a replay recorded.
using GivenSettings = std::vector<std::pair<const Setting*, std::vector<double>>>;

/// `settings` with what was given.
PlaySettings changed(PlaySettings settings, const GivenSettings& given);

/// Device's axes (x to the right, y away from the user, z up) that the box's axes follow.
using Axes = std::array<Vec3, 3>;
/// Reads "x,-z,y"; nothing when it is not like that.
std::optional<Axes> read_axes(const std::string& text);

/// What a file of --config says.
struct PlayFile {
  std::string name;  ///< empty: there is none
  GivenSettings given = {};
  std::string axes = {};  ///< as it is written; empty: it has none
};

/// Adds the options --gain, --max-force, --scale and --config, whose file's table [play] has keys
/// `axes`, gain, max-force and scale, and sub-tables. `given` and `file` must outlive `app`.
void add_settings(CommandLine& app, GivenSettings& given, PlayFile& file);

/// "NAME sets max-force = 1.5, axes = -z,x,y": what counts of a file beside the command line's
/// own settings.
std::string file_text(const PlayFile& file, const GivenSettings& given);

/// The other keys of [play] as a table for the help.
std::string settings_help();

}  // namespace hapgrid
