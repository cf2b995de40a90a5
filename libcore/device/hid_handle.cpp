#include "libcore/device/hid_handle.hpp"

#include <hidapi/hidapi.h>

#include <algorithm>

#include "libcore/base/error.hpp"
#include "libcore/device/evdev_handle.hpp"
#include "libcore/device/hid_bus.hpp"

namespace hapgrid {

namespace {

std::string shown_id(std::span<const std::uint8_t> report) {
  return std::to_string(report.empty() ? 0 : report[0]);
}

}  // namespace

HidHandle::HidHandle(const std::string& path) : path_(path), device_(hid_open_path(path.c_str())) {
  if (!device_) throw DeviceError(open_failure(path, narrow(hid_error(nullptr))));
}

HidHandle::~HidHandle() { hid_close(device_); }

int HidHandle::read(std::span<std::uint8_t> buffer, int milliseconds) noexcept {
  const int got = hid_read_timeout(device_, buffer.data(), buffer.size(), milliseconds);
  return got < 0 ? -1 : std::min(got, static_cast<int>(buffer.size()));
}

bool HidHandle::try_write(std::span<const std::uint8_t> report) noexcept {
  const int took = hid_write(device_, report.data(), report.size());
  short_write_ = took >= 0 && took < static_cast<int>(report.size()) ? took : -1;
  return took >= static_cast<int>(report.size());
}

std::string HidHandle::error() const {
  if (short_write_ >= 0) return "took only " + std::to_string(short_write_) + " bytes of it";
  return narrow(hid_error(device_));
}

void HidHandle::write(std::span<const std::uint8_t> report) {
  if (!try_write(report))
    throw DeviceError(path_ + ": output report " + shown_id(report) + ": " + error());
}

void HidHandle::set_feature(std::span<const std::uint8_t> report) {
  if (hid_send_feature_report(device_, report.data(), report.size()) <
      static_cast<int>(report.size()))
    throw DeviceError(path_ + ": feature report " + shown_id(report) + ": " +
                      narrow(hid_error(device_)));
}

std::unique_ptr<HidWire> open_wire(const std::string& path) {
  if (is_evdev(path)) return std::make_unique<EvdevHandle>(path);
  return std::make_unique<HidHandle>(path);
}

}  // namespace hapgrid
