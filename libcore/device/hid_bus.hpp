// Which HID devices there are, which of them is meant, and what to tell a user whose device cannot
// be found or opened.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hapgrid {

/// One top-level collection of a device: a device that has several appears several times, with the
/// same path. Texts come from the device and are printable here.
struct HidInfo {
  std::string path;  ///< "/dev/hidraw0"
  std::uint16_t vid = 0, pid = 0;
  std::string serial, manufacturer, product;
  std::uint16_t usage_page = 0, usage = 0;
  int interface = -1;  ///< USB's; -1 where there is none (Bluetooth, uhid)
};

/// What a device has to be; what is not set is any.
struct HidMatch {
  // All with initializers, so that {.serial = "1"} is without warnings.
  std::string path{};
  std::optional<std::uint16_t> vid{}, pid{}, usage_page{}, usage{};
  std::optional<int> interface {};
  std::string serial{};

  bool fits(const HidInfo& info) const;
};

/// What WHICH on a command line means: a path "/dev/hidraw3"; "16c0:0486", also with ":SERIAL";
/// anything else is a serial number. Empty: any device.
/// @throw DeviceError for a path that is no device's, such as "/dev/".
HidMatch parse_hid_match(std::string_view which);

/// "16c0:0486, usage ffab:0200", for messages.
std::string to_text(const HidMatch& match);

/// All HID devices, by path, then usage; those that may not be opened, too.
std::vector<HidInfo> list_hid();

/// Those of `devices` that fit, one for each path.
std::vector<HidInfo> find_hid(const std::vector<HidInfo>& devices, const HidMatch& match);

/// The one device that fits.
/// @param hint how the user names one, for the message: "--device pid:WHICH".
/// @throw DeviceError "no device is ...: ..." with what there is instead, or "2 devices are ...".
HidInfo find_one_hid(const std::vector<HidInfo>& devices, const HidMatch& match,
                     const std::string& hint);

/// "Teensy RawHID (16c0:0486)".
std::string shown_name(const HidInfo& info);

/// The table of `play --list-devices`: a line for each collection, and a last line for devices that
/// may not be opened. Says so when there is nothing.
std::string list_text(const std::vector<HidInfo>& devices);

/// The raw report descriptor of an open-able path, from sysfs, else by ioctl; at most 4096 bytes.
/// @throw DeviceError
std::vector<std::uint8_t> read_report_descriptor(const std::string& path,
                                                 const std::string& sysfs = "/sys/class/hidraw");

/// 16 bytes a line, in hex.
std::string hex_text(const std::vector<std::uint8_t>& bytes);

/// One line for a path that could not be opened: what hidapi said, and when it was the permission,
/// the udev rule that gives it.
std::string open_failure(const std::string& path, const std::string& reason);

/// That line's help, for a device of these numbers.
std::string permission_help(std::uint16_t vid, std::uint16_t pid);

/// One printable line of UTF-8 from hidapi's wide texts, which may be null.
std::string narrow(const wchar_t* text);

}  // namespace hapgrid
