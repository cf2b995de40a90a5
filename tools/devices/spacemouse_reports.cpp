#include "tools/devices/spacemouse_reports.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace hapgrid {

namespace {

constexpr unsigned kSecondButton = 2;

}  // namespace

bool is_spacemouse(std::uint16_t vendor, std::uint16_t product) {
  if (vendor == 0x046d) {  // Logitech sold them until 2013, among its mice
    constexpr std::uint16_t kProducts[] = {0xc603, 0xc605, 0xc606, 0xc621, 0xc623, 0xc625,
                                           0xc626, 0xc627, 0xc628, 0xc629, 0xc62b};
    return std::find(std::begin(kProducts), std::end(kProducts), product) != std::end(kProducts);
  }
  // 3Dconnexion's own. From c650 on there are mice and keyboards, except the universal receiver.
  return vendor == 0x256f && ((product >= 0xc62e && product < 0xc650) || product == 0xc652);
}

bool decode_spacemouse(std::span<const std::uint8_t> report, hapgrid_device_state& state) noexcept {
  if (report.size() >= 2 && report[0] == 3) {
    const auto buttons = report.subspan(1);
    const bool next = (buttons[0] & kSecondButton) != 0;
    const bool other =
        (buttons[0] & ~kSecondButton) != 0 ||
        std::any_of(buttons.begin() + 1, buttons.end(), [](auto b) { return b != 0; });
    state.flags = (next ? std::uint32_t{HAPGRID_DEVICE_NEXT} : 0) |
                  (other ? std::uint32_t{HAPGRID_DEVICE_RESET} : 0);
    return true;
  }
  if (report.size() < 7 || report[0] != 1) return false;
  const auto deflection = [&](std::size_t axis) {
    const auto raw = static_cast<std::int16_t>(report[1 + 2 * axis] | report[2 + 2 * axis] << 8);
    if (std::abs(raw) <= kSpaceMouseDeadZone) return 0.0;
    return std::clamp(raw / kSpaceMouseFull, -1.0, 1.0);
  };
  // 0 - x, because a log should not show a deflection of -0.
  state.position[0] = deflection(0);
  state.position[1] = 0 - deflection(1);
  state.position[2] = 0 - deflection(2);
  return true;
}

}  // namespace hapgrid
