#include "tools/play/devices.hpp"

#include <string_view>

#include "libcore/device/keyboard.hpp"
#include "libcore/device/path.hpp"

namespace hapgrid {

namespace {

constexpr std::string_view kPath = "path:";
constexpr std::string_view kKeys = "keys";

/// What follows `prefix` in `name`; empty when something else stands there.
std::string after(std::string_view prefix, const std::string& name) {
  return name.starts_with(prefix) ? name.substr(prefix.size()) : std::string();
}

KeyboardOptions keyboard_options(const PlayOptions& options, const Box& box) {
  KeyboardOptions keys;
  keys.low = box.position({0, 0, 0});
  keys.high = box.position({box.counts[0] - 1, box.counts[1] - 1, box.counts[2] - 1});
  for (int a = 0; a < 3; ++a)
    keys.start[a] =
        options.key_start.empty() ? (keys.low[a] + keys.high[a]) / 2 : options.key_start[a];
  keys.step = options.key_step > 0 ? options.key_step : box.spacing / 2;
  return keys;
}

}  // namespace

std::string device_mistake(const std::string& name) {
  if (name == kKeys || !after(kPath, name).empty()) return "";
  return "'" + name + "' is not a device: path:FILE or keys";
}

bool reads_standard_input(const std::string& name) { return after(kPath, name) == "-"; }

OpenDevice open_device(const PlayOptions& options, const Box& box) {
  if (const std::string file = after(kPath, options.device); !file.empty()) {
    // new: a device is not moved, and open() makes it in place.
    auto path = std::unique_ptr<PathDevice>(new PathDevice(PathDevice::open(file)));
    const std::size_t ticks = path->size();
    return {.device = std::move(path), .live = false, .ticks = ticks};
  }
  return {.device = std::make_unique<KeyboardDevice>(keyboard_options(options, box))};
}

}  // namespace hapgrid
