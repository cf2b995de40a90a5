// Lists HID devices, finds the one that the user means, and tells the user what helps when a device
// cannot be found or opened.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hapgrid {

/// One top-level collection of a device. A device with several collections is listed several times,
/// with the same path. Its texts come from the device and were made printable.
struct HidInfo {
  std::string path;  ///< "/dev/hidraw0"
  std::uint16_t vid = 0, pid = 0;
  std::string serial, manufacturer, product;
  std::uint16_t usage_page = 0, usage = 0;
  int interface = -1;  ///< number of the USB interface; -1 without USB (Bluetooth, uhid)
};

/// Which devices are meant. A field that is not set matches every device.
struct HidMatch {
  // With initializers, so that {.serial = "1"} gives no warnings.
  std::string path{};
  std::optional<std::uint16_t> vid{}, pid{}, usage_page{}, usage{};
  std::optional<int> interface {};
  std::string serial{};

  bool fits(const HidInfo& info) const;
};

/// Parses the WHICH of a command line: a path "/dev/hidraw3"; "16c0:0486", also with ":SERIAL"; any
/// other text is a serial number; an empty text means every device.
/// @throw DeviceError for a path that is a directory, such as "/dev/".
HidMatch parse_hid_match(std::string_view which);

/// "16c0:0486, usage ffab:0200", for messages.
std::string to_text(const HidMatch& match);

/// All HID devices, sorted by path and usage, including those that the user may not open.
std::vector<HidInfo> list_hid();

/// The devices that fit, one entry for each path.
std::vector<HidInfo> find_hid(const std::vector<HidInfo>& devices, const HidMatch& match);

/// The one device that fits.
/// @param hint how the user can name one device, for the message: "--device spacemouse:WHICH".
/// @throw DeviceError "no device is ...: ..." with a list of the devices, or "2 devices are ...".
HidInfo find_one_hid(const std::vector<HidInfo>& devices, const HidMatch& match,
                     const std::string& hint);

/// "Teensy RawHID (16c0:0486)".
std::string shown_name(const HidInfo& info);

/// Whether nothing but the device itself can keep the user from opening it.
bool may_open(const std::string& path);

/// One line for a path that could not be opened: what hidapi said, or, when the permission is
/// missing, the udev rule that gives it.
std::string open_failure(const std::string& path, const std::string& reason);

/// The udev rule, and how to install it, for a device with these USB ids.
std::string permission_help(std::uint16_t vid, std::uint16_t pid);
/// What to do with a rule that names a device.
std::string udev_help(const std::string& rule);

/// Four digits in hex.
std::string hex4(unsigned value);

/// A wide text of hidapi, which may be null, as one printable line of UTF-8.
std::string narrow(const wchar_t* text);

}  // namespace hapgrid
