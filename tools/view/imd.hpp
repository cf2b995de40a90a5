// view --imd: frames for the viewers of molecules that chemists have
// (libcore/scene/imd_server.hpp).
#pragma once

#include <optional>
#include <string>

#include "libcore/scene/imd_server.hpp"

namespace hapgrid {

/// [ADDRESS:]PORT, as in 8888, 0.0.0.0:8888 or [::1]:8888; nothing when it is not that.
std::optional<ImdOptions> read_imd(const std::string& text);

/// Serves the frames until their end. A stream is read as fast as it comes, so that its writer
/// never waits; a file waits for the first viewer, and is then shown in the time in which it was
/// recorded. Says on standard error where viewers connect, what of a viewer's wishes is ignored,
/// and at the end what was sent.
/// @throw std::system_error, FormatError; Error when there is no frame
void run_imd(const std::string& frames, const ImdOptions& options);

}  // namespace hapgrid
