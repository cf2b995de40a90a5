// stats --log of a session: report, array, text.
#pragma once

#include <string>

#include "libcore/base/file.hpp"

namespace hapgrid {

struct SessionOptions {
  std::string export_file;  ///< empty: no text
  std::string npy;          ///< empty: no array
  std::string format;       ///< of the report, which is written when the two above are empty
  std::string output;       ///< where the report goes
};

/// @throw Error, std::system_error
void run_session(InputFile file, const SessionOptions& options);

}  // namespace hapgrid
