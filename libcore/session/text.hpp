// A session as text, for other programs.
#pragma once

#include <string>

#include "libcore/session/session.hpp"

namespace hapgrid {

/// The line "# t x y z force_x force_y force_z sent_x sent_y sent_z l0 ... l7 flags lateness_us
/// compute_us", separated by tabs. `force` is the model's, before the safety core.
std::string session_text_header();

/// Appends a tick as such a line: t in seconds, numbers with 17 digits, flags as a whole number.
void append_session_text(std::string& text, const SessionHeader& header, const TickRecord& tick);

}  // namespace hapgrid
