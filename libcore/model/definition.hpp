// MODEL.toml: the file in which a user defines a grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libcore/grid/spec.hpp"

namespace hapgrid {

/// The most bytes of all files of [model.files] together: 64 MiB. Their contents go, compressed,
/// into every shard's header.
inline constexpr std::size_t kMaxFileBytes = 64 << 20;

/// A seed point of the file: a position, and its states if the file gives them.
struct SeedDefinition {
  Vec3 position{};
  std::vector<std::vector<double>> states;
};

struct Definition {
  std::string model;  ///< the plug-in's name, or that by which grids know the process
  std::vector<std::string> command;  ///< of a process: program and arguments; empty: a plug-in
  double timeout_seconds = 60;       ///< for an answer of a process

  std::vector<Parameter> parameters;  ///< ascending by key
  Box box;
  std::uint32_t max_levels = 64;
  Stored store;                       ///< beside what the model stores by itself
  std::vector<SeedDefinition> seeds;  ///< empty: the corners of the box
};

/// Reads a definition. Keys:
///   [model] plugin, or process (texts: program and arguments), name, and timeout (seconds);
///   [model.parameters] the model's own;
///   [model.files] names of text files, whose contents become parameters of the same keys: a grid
///   carries everything that its model was made from;
///   [grid] origin (3 numbers), spacing, counts (3 whole numbers);
///   [search] max_levels (default 64), store (of "energy", "force", "shape");
///   [seeds] points (positions), states (optional: for each point a list of states).
/// @param name the file's name, for messages.
/// @param overrides "key=value" each, the key dotted ("grid.spacing"), the value as TOML writes it;
/// a value that is no TOML is taken as a text.
/// @param read_file the text of a file of [model.files], by the name that stands there.
/// @throw Error "NAME: line L: ..." for a missing, unknown or ill-typed key; what read_file throws.
Definition read_definition(const std::string& text, const std::string& name,
                           const std::vector<std::string>& overrides,
                           const std::function<std::string(const std::string&)>& read_file);

/// Reads only [model] of a definition, from a file that a user names to allow its command.
/// @throw Error as above, and when the model is a plug-in.
Definition read_process(const std::string& text, const std::string& name);

}  // namespace hapgrid
