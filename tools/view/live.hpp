// The ways in which view shows frames as they come, each with a library of its own. "-" is standard
// input.
#pragma once

#include <string>

#include "libcore/scene/drawing.hpp"

namespace hapgrid {

/// Where a server listens.
struct Place {
  std::string address;  ///< IPv4
  int port = 0;         ///< 0: one that is free
};

/// A server of HTTP and WebSockets for the browsers that watch a play. Writes the page's address to
/// standard output, and serves it until the process ends. Only who knows the address gets in: it
/// has 128 random bits. @throw Error, std::system_error; FormatError of the frames
void run_web(const std::string& frames, const Place& place, const RenderOptions& how);

/// Frames for the viewers of molecules that chemists have, over TCP, to several of them at once
/// (tools/view/imd_protocol.hpp), until their end. Nothing that a viewer sends reaches the play. A
/// stream is read as fast as it comes, so that its writer never waits; a file waits for the first
/// viewer, and is then shown in the time in which it was recorded. Says on standard error where
/// viewers connect, what of a viewer's wishes is ignored, and at the end what was sent.
/// @throw std::system_error, FormatError; Error when there is no frame
void run_imd(const std::string& frames, const Place& place);

/// Shows the frames on standard output, a terminal, until they end, and leaves the last picture
/// there. `mode` is "auto", "symbols" or "sixel"; the size of `how` is not used: it is the
/// terminal's. The terminal's input is neither read nor changed, so another program can use the
/// keyboard. A signal ends the process after the terminal is as before.
/// @throw Error when standard output is no terminal; std::system_error; what Feed throws.
void run_terminal(const std::string& frames, const RenderOptions& how, const std::string& mode);

}  // namespace hapgrid
