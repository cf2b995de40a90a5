// play --list-devices.
#pragma once

#include <set>
#include <string>

namespace hapgrid {

/// All devices that our adapters find, and the adapters that lie in the folder ../devices beside
/// this program, as a table that begins with the text for --device. What keeps the user from
/// opening a device stands below it, a line each.
std::string devices_table();
/// The last part of it: what keeps the user from opening devices.
std::set<std::string> permissions_lacking();

}  // namespace hapgrid
