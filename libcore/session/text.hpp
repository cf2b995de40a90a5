// A session as text, for other programs.
#pragma once

#include <string>

#include "libcore/session/session.hpp"

namespace hapgrid {

/// The line "# t x y z fx fy fz l0 ... l7 rawx rawy rawz flags lateness_us compute_us", separated
/// by tabs.
std::string session_text_header();

/// Appends a tick as such a line: t in seconds, numbers with 17 digits, flags as a whole number.
void append_session_text(std::string& text, const SessionHeader& header, const TickRecord& tick);

}  // namespace hapgrid
