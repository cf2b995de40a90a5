#include "tools/devices/stick_list.hpp"

#include <linux/input.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace fs = std::filesystem;

namespace {

std::string first_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

/// The bits of a file of sysfs: words in hex, the highest first.
class Bits {
 public:
  explicit Bits(const fs::path& file) {
    std::istringstream in(first_line(file));
    for (std::string word; in >> word;)
      words_.insert(words_.begin(), std::strtoul(word.c_str(), nullptr, 16));
  }
  bool has(unsigned bit) const {
    constexpr unsigned kWord = 8 * sizeof(unsigned long);
    return bit / kWord < words_.size() && (words_[bit / kWord] >> bit % kWord & 1) != 0;
  }
  bool any(unsigned first, unsigned last) const {
    for (unsigned bit = first; bit <= last; ++bit)
      if (has(bit)) return true;
    return false;
  }

 private:
  std::vector<unsigned long> words_;
};

std::uint16_t number(const fs::path& file) {
  return static_cast<std::uint16_t>(std::strtoul(first_line(file).c_str(), nullptr, 16));
}

std::string names(const std::vector<EvdevInfo>& devices) {
  std::string text;
  for (const EvdevInfo& info : devices)
    text += (text.empty() ? "" : ", ") + shown_name(info) + " at " + info.path;
  return text;
}

}  // namespace

std::string stick_permission(const EvdevInfo& info) {
  return udev_help("KERNEL==\"event*\", ATTRS{id/vendor}==\"" + hex4(info.vid) +
                   "\", ATTRS{id/product}==\"" + hex4(info.pid) + "\"");
}

std::vector<EvdevInfo> list_evdev(const std::string& sysfs) {
  std::vector<EvdevInfo> devices;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(sysfs, none)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("event")) continue;
    const fs::path device = entry.path() / "device", has = device / "capabilities";
    const Bits axes(has / "abs"), keys(has / "key"), effects(has / "ff");
    const Bits properties(device / "properties");
    if (properties.any(INPUT_PROP_POINTER, INPUT_PROP_DIRECT) ||
        properties.has(INPUT_PROP_ACCELEROMETER))
      continue;
    const bool force = effects.has(FF_CONSTANT) && (axes.has(ABS_X) || axes.has(ABS_WHEEL));
    const bool stick = axes.has(ABS_X) && axes.has(ABS_Y) && keys.any(BTN_JOYSTICK, BTN_DIGI - 1);
    if (!force && !stick) continue;
    EvdevInfo info;
    info.path = "/dev/input/" + name;
    info.vid = number(device / "id" / "vendor");
    info.pid = number(device / "id" / "product");
    info.serial = printable_line(first_line(device / "uniq"));
    info.product = printable_line(first_line(device / "name"));
    info.constant = effects.has(FF_CONSTANT);
    info.rumble = effects.has(FF_RUMBLE);
    devices.push_back(std::move(info));
  }
  std::sort(devices.begin(), devices.end(), [](const EvdevInfo& a, const EvdevInfo& b) {
    return std::pair(a.path.size(), a.path) < std::pair(b.path.size(), b.path);
  });
  return devices;
}

EvdevInfo find_one_evdev(const std::vector<EvdevInfo>& devices, const HidMatch& match) {
  std::vector<EvdevInfo> found;
  std::copy_if(devices.begin(), devices.end(), std::back_inserter(found),
               [&](const EvdevInfo& info) { return match.fits(info); });
  const bool any = to_text(match) == to_text(HidMatch());
  const auto keep = [&](bool EvdevInfo::*effect) {
    if (any && std::any_of(found.begin(), found.end(), [&](const auto& i) { return i.*effect; }))
      std::erase_if(found, [&](const EvdevInfo& info) { return !(info.*effect); });
  };
  keep(&EvdevInfo::constant);
  keep(&EvdevInfo::rumble);
  if (found.size() == 1) return found.front();
  const std::string what = any ? "" : " are " + to_text(match);
  if (!found.empty())
    throw DeviceError(std::to_string(found.size()) + " gamepads or sticks" + what + ": " +
                      names(found) + ": choose one by its path (--device evdev:WHICH)");
  throw DeviceError(
      (any ? "there is no gamepad or stick"
           : "no gamepad or stick is " + to_text(match) +
                 (devices.empty() ? "; there is none at all" : "; there is " + names(devices))) +
      " (play --list-devices shows all)");
}

std::string evdev_open_failure(const std::string& path, int error) {
  if (error == EACCES)
    for (const EvdevInfo& info : list_evdev())
      if (info.path == path) return path + ": permission denied: " + stick_permission(info);
  return printable_line(path) + ": cannot be opened: " + std::generic_category().message(error);
}

}  // namespace hapgrid
