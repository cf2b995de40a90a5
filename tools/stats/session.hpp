// stats of a session: report, array.
#pragma once

#include <string>

#include "libcore/base/file.hpp"

namespace hapgrid {

/// @param npy the array to write; empty: the report is written to `output`
/// @throw Error, std::system_error
void run_session(InputFile file, const std::string& npy, bool as_json, const std::string& output);

}  // namespace hapgrid
