// The live page: a server of HTTP and WebSockets for the browsers that watch a play.
#pragma once

#include <string>

#include "libcore/scene/drawing.hpp"

namespace hapgrid {

struct WebOptions {
  RenderOptions render;
  std::string address;  ///< IPv4, on which the server listens
  int port = 0;         ///< 0: one that is free
};

/// Writes the page's address to standard output, and serves it until the process ends.
/// Only who knows the address gets in: it has 128 random bits.
/// @throw Error, std::system_error; FormatError of the frames
void run_web(const std::string& frames, const WebOptions& options);

}  // namespace hapgrid
