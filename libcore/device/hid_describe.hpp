// A report descriptor as text, for people who write a profile.
#pragma once

#include <string>

#include "libcore/device/hid_descriptor.hpp"

namespace hapgrid {

/// A line for each field, in the descriptor's order, with a heading for each application
/// collection:
///
///   Joystick
///     input 1: byte 1 bit 0: 2 x 16 bits: X, Y: logical -32767..32767
///     output 5: byte 1 bit 0: 8 bits: Effect Block Index (in Set Constant Force Report): ...
///
/// Bytes are counted as hidapi counts them: byte 0 is the report's id. Usages without a known name
/// are page:usage in hex. Ends with a newline.
std::string describe(const HidDescriptor& descriptor);

}  // namespace hapgrid
