// view --imd: frames for the viewers of molecules that chemists have, over TCP, to several of them
// at once (tools/view/imd_protocol.hpp). Nothing that a viewer sends reaches the play.
#pragma once

#include <string>

namespace hapgrid {

/// Serves the frames until their end. A stream is read as fast as it comes, so that its writer
/// never waits; a file waits for the first viewer, and is then shown in the time in which it was
/// recorded. Says on standard error where viewers connect, what of a viewer's wishes is ignored,
/// and at the end what was sent.
/// @param address IPv4 @param port 0: one that is free
/// @throw std::system_error, FormatError; Error when there is no frame
void run_imd(const std::string& frames, const std::string& address, int port);

}  // namespace hapgrid
