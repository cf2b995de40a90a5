#include "tools/devices/hid_bus.hpp"

#include <hidapi/hidapi.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <memory>
#include <tuple>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace fs = std::filesystem;

namespace {

// A text of USB has at most 126 characters.
constexpr std::size_t kMaxText = 500;
constexpr std::size_t kMaxListed = 8;

std::string pair_text(unsigned high, unsigned low) { return hex4(high) + ":" + hex4(low); }

std::optional<std::uint16_t> parse_hex4(std::string_view text) {
  std::uint16_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value, 16);
  if (text.size() != 4 || error != std::errc() || rest != end) return std::nullopt;
  return value;
}

/// "Teensy RawHID (16c0:0486) at /dev/hidraw0, ...", with at most kMaxListed devices.
std::string names(const std::vector<HidInfo>& devices) {
  std::string text;
  std::size_t count = 0;
  for (const HidInfo& info : devices) {
    if (count++ == kMaxListed) return text + ", ...";
    text += (text.empty() ? "" : ", ") + shown_name(info) + " at " + info.path;
    if (!info.serial.empty()) text += " with serial " + info.serial;
  }
  return text;
}

}  // namespace

std::string hex4(unsigned value) { return format("{:04x}", value & 0xffff); }

bool HidMatch::fits(const HidInfo& info) const {
  return (path.empty() || path == info.path) && (!vid || *vid == info.vid) &&
         (!pid || *pid == info.pid) && (!usage_page || *usage_page == info.usage_page) &&
         (!usage || *usage == info.usage) && (!interface || *interface == info.interface) &&
         (serial.empty() || serial == info.serial);
}

HidMatch parse_hid_match(std::string_view which) {
  HidMatch match;
  if (which.empty()) return match;
  if (which.front() == '/') {
    // The path may be a link that a udev rule made, but hidapi lists the device's own name.
    std::error_code error;
    const fs::path real = fs::canonical(fs::path(which), error);
    match.path = error ? std::string(which) : real.string();
    if (!error && fs::is_directory(real))
      throw DeviceError(match.path + ": is a directory, not a device");
    return match;
  }
  if (which.size() >= 9 && which[4] == ':' && (which.size() == 9 || which[9] == ':')) {
    match.vid = parse_hex4(which.substr(0, 4));
    match.pid = parse_hex4(which.substr(5, 4));
    if (match.vid && match.pid) {
      if (which.size() > 10) match.serial = which.substr(10);
      return match;
    }
  }
  match = {};
  match.serial = which;
  return match;
}

std::string to_text(const HidMatch& match) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (match.vid && match.pid) {
    add(pair_text(*match.vid, *match.pid));
  } else if (match.vid) {
    add("vendor " + hex4(*match.vid));
  } else if (match.pid) {
    add("product " + hex4(*match.pid));
  }
  if (!match.path.empty()) add(printable_line(match.path));
  if (match.interface) add("interface " + std::to_string(*match.interface));
  if (match.usage_page && match.usage) {
    add("usage " + pair_text(*match.usage_page, *match.usage));
  } else if (match.usage_page) {
    add("usage page " + hex4(*match.usage_page));
  } else if (match.usage) {
    add("usage " + hex4(*match.usage));
  }
  if (!match.serial.empty()) add("serial " + printable_line(match.serial));
  return text.empty() ? "any HID device" : text;
}

std::vector<HidInfo> list_hid() {
  const std::unique_ptr<hid_device_info, decltype(&hid_free_enumeration)> list(
      hid_enumerate(0, 0), &hid_free_enumeration);
  std::vector<HidInfo> devices;
  for (const hid_device_info* at = list.get(); at; at = at->next)
    devices.push_back({.path = at->path ? at->path : "",
                       .vid = at->vendor_id,
                       .pid = at->product_id,
                       .serial = narrow(at->serial_number),
                       .manufacturer = narrow(at->manufacturer_string),
                       .product = narrow(at->product_string),
                       .usage_page = at->usage_page,
                       .usage = at->usage,
                       .interface = at->interface_number});
  std::sort(devices.begin(), devices.end(), [](const HidInfo& a, const HidInfo& b) {
    // The size comes first, so that hidraw10 comes after hidraw9.
    return std::tuple(a.path.size(), a.path, a.usage_page, a.usage) <
           std::tuple(b.path.size(), b.path, b.usage_page, b.usage);
  });
  return devices;
}

std::vector<HidInfo> find_hid(const std::vector<HidInfo>& devices, const HidMatch& match) {
  std::vector<HidInfo> found;
  for (const HidInfo& info : devices) {
    const auto same = [&info](const HidInfo& other) { return other.path == info.path; };
    if (match.fits(info) && std::none_of(found.begin(), found.end(), same)) found.push_back(info);
  }
  return found;
}

HidInfo find_one_hid(const std::vector<HidInfo>& devices, const HidMatch& match,
                     const std::string& hint) {
  const std::vector<HidInfo> found = find_hid(devices, match);
  if (found.size() == 1) return found.front();
  if (!found.empty())
    throw DeviceError(std::to_string(found.size()) + " devices are " + to_text(match) + ": " +
                      names(found) + ": choose one by its path or serial (" + hint + ")");
  const std::vector<HidInfo> all = find_hid(devices, {});
  throw DeviceError("no device is " + to_text(match) + "; " +
                    (all.empty() ? "there is no HID device at all" : "there is " + names(all)) +
                    " (play --list-devices shows all)");
}

std::string shown_name(const HidInfo& info) {
  const std::string& name = info.product.empty() ? info.manufacturer : info.product;
  return (name.empty() ? "device" : name) + " (" + pair_text(info.vid, info.pid) + ")";
}

bool may_open(const std::string& path) {
  return ::access(path.c_str(), R_OK | W_OK) == 0 || errno != EACCES;
}

std::string open_failure(const std::string& path, const std::string& reason) {
  const std::string shown = printable_line(path) + ": ";
  if (may_open(path)) return shown + "cannot be opened: " + reason;
  // The rule is for one device, so it needs the device's USB ids.
  for (const HidInfo& info : list_hid())
    if (info.path == path)
      return shown + "permission denied: " + permission_help(info.vid, info.pid);
  return shown + "permission denied";
}

std::string permission_help(std::uint16_t vid, std::uint16_t pid) {
  return udev_help("KERNEL==\"hidraw*\", ATTRS{idVendor}==\"" + hex4(vid) +
                   "\", ATTRS{idProduct}==\"" + hex4(pid) + "\"");
}

std::string udev_help(const std::string& rule) {
  return "put the line " + rule +
         ", TAG+=\"uaccess\" into /etc/udev/rules.d/70-hapgrid.rules, then run 'udevadm control "
         "--reload && udevadm trigger' as root";
}

std::string narrow(const wchar_t* text) {
  std::string utf8;
  for (; text && *text && utf8.size() < kMaxText; ++text) {
    const std::uint32_t c = std::char_traits<wchar_t>::to_int_type(*text);
    if (c < 0x80) {
      utf8 += static_cast<char>(c);
    } else if (c < 0x800) {
      utf8 += {static_cast<char>(0xc0 | c >> 6), static_cast<char>(0x80 | (c & 63))};
    } else if (c < 0x10000) {
      utf8 += {static_cast<char>(0xe0 | c >> 12), static_cast<char>(0x80 | (c >> 6 & 63)),
               static_cast<char>(0x80 | (c & 63))};
    } else if (c < 0x110000) {
      utf8 += {static_cast<char>(0xf0 | c >> 18), static_cast<char>(0x80 | (c >> 12 & 63)),
               static_cast<char>(0x80 | (c >> 6 & 63)), static_cast<char>(0x80 | (c & 63))};
    } else {
      utf8 += '?';
    }
  }
  return printable_line(utf8, kMaxText);  // surrogates and the like become '?'
}

}  // namespace hapgrid
