// Pictures, drawn by the program gnuplot.
//
// A script is data and commands at once, and some of its strings come from shards, which are
// hostile. Strings enter a script through gnuplot_string() only.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/grid/spec.hpp"
#include "tools/stats/motion_log.hpp"
#include "tools/stats/slice.hpp"

namespace hapgrid {

/// `text` as a string of a gnuplot script: a printable line (base/text.hpp) in single quotes, where
/// gnuplot expands nothing. Backslashes and backquotes become '?' all the same.
std::string gnuplot_string(std::string_view text);

/// Runs gnuplot on `script`, which leaves `set output` alone, and puts the picture into `png`
/// (without committing it).
/// @throw Error when gnuplot is not installed or fails, with gnuplot's complaint;
/// std::system_error.
void run_gnuplot(const std::string& script, OutputFile& png);

/// The levels of each point in a plane: a coloured square for each point, and a key of the colours.
std::string slice_script(const GridSpec& spec, const Slice& slice);

/// A column of a log over another one.
struct MotionCurve {
  std::string name;
  Motion motion;
};
/// One or two curves, there and back in two colours each. Names, titles and labels may be any text.
std::string motion_script(const std::vector<MotionCurve>& curves, const std::string& title,
                          const std::string& subtitle, const std::string& x_label,
                          const std::string& y_label);

}  // namespace hapgrid
