// view --imd: frames for the viewers of molecules that chemists have, over TCP, to several of them
// at once (libcore/scene/imd_protocol.hpp). Nothing that a viewer sends reaches the play.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace hapgrid {

/// [ADDRESS:]PORT, as in 8888, 0.0.0.0:8888 or [::1]:8888, of which the address is in numbers, and
/// by default that of this machine; nothing when it is not that.
std::optional<std::pair<std::string, std::uint16_t>> read_imd(const std::string& text);

/// Serves the frames until their end at the place of read_imd(); at port 0 the system chooses one.
/// A stream is read as fast as it comes, so that its writer never waits; a file waits for the first
/// viewer, and is then shown in the time in which it was recorded. Says on standard error where
/// viewers connect, what of a viewer's wishes is ignored, and at the end what was sent.
/// @throw std::system_error, FormatError; Error when there is no frame
void run_imd(const std::string& frames, const std::string& place);

}  // namespace hapgrid
