// Numbers as text, the same in every locale.
#pragma once

#include <string>

namespace hapgrid {

/// As few digits as read back to the same double ("0.05").
std::string to_text(double value);

/// Appends `value` with 17 significant digits, as %.17g in the C locale: reads back to the same
/// double, and equal texts mean equal doubles.
void append_digits17(std::string& text, double value);

}  // namespace hapgrid
