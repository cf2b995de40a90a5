// The live page: a server of HTTP and WebSockets for the browsers that watch a play, one of which
// may be the hand.
#pragma once

#include <string>

#include "libcore/scene/drawing.hpp"

namespace hapgrid {

struct WebOptions {
  RenderOptions render;
  std::string address;  ///< IPv4, on which the server listens
  int port = 0;         ///< 0: one that is free
  std::string hand;     ///< the named pipe of play for the hand; empty: all only watch
  bool close = false;   ///< end after the last frame
};

/// Writes the page's address to standard output, and serves it until the frames end, with `close`,
/// or the process. Only who knows the address gets in: it has 128 random bits.
/// @throw Error, std::system_error; FormatError of the frames
void run_web(const std::string& frames, const WebOptions& options);

}  // namespace hapgrid
