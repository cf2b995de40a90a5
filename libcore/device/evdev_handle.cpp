#include "libcore/device/evdev_handle.hpp"

#include <fcntl.h>
#include <libevdev/libevdev.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <system_error>
#include <thread>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"
#include "libcore/device/evdev_bus.hpp"

namespace hapgrid {

namespace {

template <class Value>
bool take(std::span<const std::uint8_t> report, Value& value) noexcept {
  if (report.size() != 1 + sizeof value) return false;
  std::memcpy(&value, &report[1], sizeof value);
  return true;
}

input_event playback(int id, int times) noexcept {
  input_event event{};
  event.type = EV_FF;
  event.code = static_cast<std::uint16_t>(id);
  event.value = times;
  return event;
}

}  // namespace

bool is_evdev(const std::string& path) { return path.starts_with("/dev/input/"); }

EvdevHandle::EvdevHandle(const std::string& path) : path_(path) {
  fd_ = FileDescriptor(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK));
  if (!fd_) throw DeviceError(evdev_open_failure(path, errno));
  if (const int failed = libevdev_new_from_fd(fd_.get(), &device_); failed < 0)
    throw DeviceError(printable_line(path) +
                      ": is no event device: " + std::generic_category().message(-failed));
  for (unsigned code = ABS_CNT; code-- > 0;)
    if (int value; libevdev_fetch_event_value(device_, EV_ABS, code, &value)) {
      input_event event{};
      event.type = EV_ABS;
      event.code = static_cast<std::uint16_t>(code);
      event.value = value;
      first_.push_back(event);
    }
}

EvdevHandle::~EvdevHandle() { libevdev_free(device_); }

EvdevLayout EvdevHandle::layout() const {
  const auto has = [this](unsigned type, unsigned code) {
    return libevdev_has_event_code(device_, type, code) == 1;
  };
  const char* const name = libevdev_get_name(device_);
  EvdevLayout layout{.name = printable_line(name ? name : "event device") + " (" + path_ + ")",
                     .constant = has(EV_FF, FF_CONSTANT),
                     .rumble = has(EV_FF, FF_RUMBLE),
                     .gain = has(EV_FF, FF_GAIN),
                     .autocenter = has(EV_FF, FF_AUTOCENTER),
                     .axes = {}};
  // The second stick is Rx, Ry for drivers of gamepads, and Z, Rz for a gamepad of HID.
  const std::array<std::array<std::uint16_t, 2>, 3> codes{
      {{ABS_X, ABS_WHEEL}, {ABS_Y, ABS_Y}, {ABS_RY, ABS_RZ}}};
  for (std::size_t a = 0; a < 3; ++a)
    for (const std::uint16_t code : codes[a]) {
      const input_absinfo* const info = libevdev_get_abs_info(device_, code);
      if (layout.axes[a] || !info || info->minimum >= info->maximum) continue;
      layout.axes[a] = {
          .code = code, .low = info->minimum, .high = info->maximum, .flat = info->flat};
    }
  return layout;
}

std::optional<input_event> EvdevHandle::next() noexcept {
  if (!first_.empty()) {
    const input_event event = first_.back();
    first_.pop_back();
    return event;
  }
  for (;;) {
    input_event event;
    const int got = libevdev_next_event(
        device_, syncing_ ? LIBEVDEV_READ_FLAG_SYNC : LIBEVDEV_READ_FLAG_NORMAL, &event);
    if (got == -EAGAIN && syncing_) {
      syncing_ = false;
      continue;
    }
    if (got < 0) {
      error_ = -got;
      return std::nullopt;
    }
    if (got == LIBEVDEV_READ_STATUS_SYNC) syncing_ = true;
    if (event.type == EV_ABS || event.type == EV_KEY) return event;
  }
}

int EvdevHandle::read(std::span<std::uint8_t> buffer, int milliseconds) noexcept {
  for (bool waited = false;; waited = true) {
    if (const auto event = next()) {
      if (buffer.size() < sizeof *event) return 0;
      std::memcpy(buffer.data(), &*event, sizeof *event);
      return sizeof *event;
    }
    if (error_ != EAGAIN && error_ != EINTR) return -1;
    if (waited) return 0;
    pollfd ready{fd_.get(), POLLIN, 0};
    if (::poll(&ready, 1, milliseconds) <= 0) return 0;
  }
}

bool EvdevHandle::send(std::span<const input_event> events) noexcept {
  const auto size = static_cast<ssize_t>(events.size_bytes());
  if (::write(fd_.get(), events.data(), events.size_bytes()) == size) return true;
  error_ = errno;
  return false;
}

bool EvdevHandle::change(std::span<const std::uint8_t> report) noexcept {
  ff_effect effect;
  if (!take(report, effect) || effect.id < 0 || static_cast<std::size_t>(effect.id) >= kSlots)
    return false;
  Slot& slot = slots_[static_cast<std::size_t>(effect.id)];
  if (std::equal(report.begin(), report.end(), slot.last.begin(), slot.last.end())) return true;
  effect.id = slot.id;
  if (::ioctl(fd_.get(), EVIOCSFF, &effect) < 0) {
    error_ = errno;
    return false;
  }
  slot.id = effect.id;
  slot.last.assign(report.begin(), report.end());
  return true;
}

bool EvdevHandle::stop(int id) noexcept {
  const input_event event = playback(id, 0);
  return send({&event, 1});
}

bool EvdevHandle::silence() noexcept {
  bool all = true;
  for (const Slot& slot : slots_)
    if (slot.id >= 0) all = stop(slot.id) && all;
  if (slots_[kEvdevForce].id >= 0) return all;
  int count = 0;
  if (::ioctl(fd_.get(), EVIOCGEFFECTS, &count) < 0) {
    error_ = errno;
    return false;
  }
  for (int id = 0; id < std::min<int>(count, FF_GAIN); ++id) {
    // A device that a program makes by uinput loses its events when 16 of them wait.
    if (id % 8 == 7) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    all = stop(id) && all;
  }
  return all;
}

bool EvdevHandle::try_write(std::span<const std::uint8_t> report) noexcept {
  error_ = EINVAL;
  input_event event;
  std::uint8_t slot = 0;
  switch (report.empty() ? EvdevWord::kPlay : static_cast<EvdevWord>(report[0])) {
    case EvdevWord::kEffect:
      return change(report);
    case EvdevWord::kPlay:
      if (!take(report, slot) || slot >= kSlots) return false;
      event = playback(slots_[slot].id, 1);
      return send({&event, 1});
    case EvdevWord::kSet:
      return take(report, event) && send({&event, 1});
    case EvdevWord::kSilence:
      return silence();
  }
  return false;
}

std::string EvdevHandle::error() const { return std::generic_category().message(error_); }

void EvdevHandle::write(std::span<const std::uint8_t> report) {
  if (!try_write(report)) throw DeviceError(path_ + ": effect: " + error());
}

}  // namespace hapgrid
