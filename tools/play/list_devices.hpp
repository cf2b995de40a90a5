// play --list-devices.
#pragma once

#include <string>

namespace hapgrid {

/// All devices that our adapters find, and the adapters that lie in the folder ../devices beside
/// this program, as a table that begins with the text for --device. What keeps the user from
/// opening a device stands below it, a line each.
std::string devices_table();

}  // namespace hapgrid
