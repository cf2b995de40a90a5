// TOML files, which users write and strangers may send: read with toml++ behind the guards that it
// lacks.
#pragma once

#include <toml++/toml.h>

#include <string>

namespace hapgrid {

/// @param name the file's, for messages.
/// @throw Error "NAME: line L: ..."
toml::table parse_toml(const std::string& text, const std::string& name);

}  // namespace hapgrid
