#include "tools/devices/hid_handle.hpp"

#include <hidapi/hidapi.h>

#include <algorithm>

#include "libcore/base/error.hpp"
#include "tools/devices/hid_bus.hpp"

namespace hapgrid {

namespace {

constexpr int kQueued = 64;  // reports, by hidraw

std::string shown_id(std::span<const std::uint8_t> report) {
  return std::to_string(report.empty() ? 0 : report[0]);
}

}  // namespace

HidHandle::HidHandle(const std::string& path)
    : path_(path), device_(hid_open_path(path.c_str())), buffer_(kMaxHidReport) {
  if (!device_) throw DeviceError(open_failure(path, narrow(hid_error(nullptr))));
}

HidHandle::~HidHandle() { hid_close(device_); }

void HidHandle::drain(const std::function<void(std::span<const std::uint8_t>)>& use) {
  for (int i = 0; i < kQueued; ++i) {
    const int got = hid_read_timeout(device_, buffer_.data(), buffer_.size(), 0);
    if (got < 0) throw DeviceError(path_ + ": read: " + narrow(hid_error(device_)));
    if (got == 0) return;
    use(std::span(buffer_).first(std::min(static_cast<std::size_t>(got), buffer_.size())));
  }
}

void HidHandle::write(std::span<const std::uint8_t> report) {
  const int took = hid_write(device_, report.data(), report.size());
  if (took >= static_cast<int>(report.size())) return;
  throw DeviceError(path_ + ": write: output report " + shown_id(report) + ": " +
                    (took >= 0 ? "took only " + std::to_string(took) + " bytes of it"
                               : narrow(hid_error(device_))));
}

void HidHandle::set_feature(std::span<const std::uint8_t> report) {
  if (hid_send_feature_report(device_, report.data(), report.size()) <
      static_cast<int>(report.size()))
    throw DeviceError(path_ + ": feature report " + shown_id(report) + ": " +
                      narrow(hid_error(device_)));
}

void write_all(HidHandle& handle, const std::vector<HidReport>& reports) {
  std::string failure;
  for (const HidReport& report : reports) {
    try {
      handle.write(report);
    } catch (const DeviceError& e) {
      if (failure.empty()) failure = e.what();
    }
  }
  if (!failure.empty()) throw DeviceError(failure);
}

}  // namespace hapgrid
