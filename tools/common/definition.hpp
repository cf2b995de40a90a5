// The MODEL.toml of a command line, as the filters that start from one take it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/model/definition.hpp"
#include "tools/common/command_line.hpp"

namespace hapgrid {

/// The largest MODEL.toml, and the largest file that one names.
inline constexpr std::uint64_t kMaxDefinitionBytes = 16 << 20;

struct DefinitionOptions {
  std::string file = "-";
  std::vector<std::string> overrides;
};

/// The positional MODEL.toml.
void add_definition_file(CommandLine& app, std::string& file);
/// The same, and --set KEY=VALUE.
void add_definition(CommandLine& app, DefinitionOptions& options);

/// Reads it, and the files that it names beside itself, which must be regular files.
/// @param output the file of --output, which must be none of them
/// @throw UsageError, Error; std::system_error
Definition load_definition(const DefinitionOptions& options, const std::string& output);

/// The text of a TOML, a regular file or "-", standard input. @throw Error; std::system_error
std::string read_toml(const std::string& name);

}  // namespace hapgrid
