// Positions as a text.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

/// A line of a path: where the HIP is, and whether it wants the next level there, as
/// DeviceInput::next does.
struct PathTick {
  Vec3 x;
  bool next = false;
  friend bool operator==(const PathTick&, const PathTick&) = default;
};

/// What a line of a path has; nothing if it has only blanks and a comment.
/// @throw Error that says what is wrong with the line.
std::optional<PathTick> parse_tick(std::string_view line);

/// Reads positions: one x y z in each line, in the model's unit of length, separated by spaces or
/// tabs; the word `next` can follow. '#' starts a comment, blank lines are skipped. Numbers are
/// those of the C locale.
/// @param name for messages.
/// @throw Error "NAME: line N: ..." for any other text, or when there is no position.
std::vector<PathTick> parse_path(std::string_view text, const std::string& name);

/// Of a whole file, "-" for standard input. @throw Error; std::system_error
std::vector<PathTick> read_path(const std::string& file);

}  // namespace hapgrid
