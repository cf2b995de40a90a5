// hapgrid-evdev: an adapter to a gamepad, stick or wheel that the kernel drives.
//
// The kernel ties effects to the handle that made them, and erases them when it is closed, however
// that happens. Any handle may stop them, that of --release, too.
//
// A gamepad says only changes: one that is silent while a stick is pushed is pushed still, and the
// kernel says when it is unplugged.
#include <fcntl.h>
#include <libevdev/libevdev.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <system_error>
#include <thread>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/text.hpp"
#include "tools/devices/adapter.hpp"
#include "tools/devices/effects.hpp"
#include "tools/devices/stick_list.hpp"

using namespace hapgrid;
using namespace std::chrono_literals;

namespace {

// Sticks take a report in 1 to 8 ms, and the kernel queues 256.
constexpr auto kForceRest = 4ms, kRumbleRest = 10ms;
constexpr auto kRepeat = std::chrono::milliseconds(kEvdevEffect) / 5;

/// An event device through libevdev.
class Handle {
 public:
  explicit Handle(const std::string& path) : path_(path) {
    fd_ = FileDescriptor(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK));
    if (!fd_) throw DeviceError(evdev_open_failure(path, errno));
    if (const int failed = libevdev_new_from_fd(fd_.get(), &device_); failed < 0)
      throw DeviceError(printable_line(path) +
                        ": is no event device: " + std::generic_category().message(-failed));
  }
  ~Handle() { libevdev_free(device_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  EvdevLayout layout() const;
  /// Where an axis is now, as an event.
  std::optional<input_event> place(std::uint16_t code) const;
  /// The next event. After an overflow of the kernel's queue, libevdev repeats the changes that
  /// were lost. @throw DeviceError
  std::optional<input_event> next();

  void send(std::uint16_t code, int value) {
    input_event event{};
    event.type = EV_FF;
    event.code = code;
    event.value = value;
    if (::write(fd_.get(), &event, sizeof event) != sizeof event) fail("effect", errno);
  }
  /// Creates an effect, or changes it, while it plays, where it has an id.
  void upload(ff_effect& effect) {
    if (::ioctl(fd_.get(), EVIOCSFF, &effect) < 0) fail("effect", errno);
  }
  void stop_all() {
    int count = 0;
    if (::ioctl(fd_.get(), EVIOCGEFFECTS, &count) < 0) fail("effects", errno);
    for (int id = 0; id < std::min<int>(count, FF_GAIN); ++id) {
      // A device that a program makes by uinput loses its events when 16 of them wait.
      if (id % 8 == 7) std::this_thread::sleep_for(1ms);
      send(static_cast<std::uint16_t>(id), 0);
    }
  }

 private:
  [[noreturn]] void fail(const char* what, int error) const {
    throw DeviceError(path_ + ": " + what + ": " + std::generic_category().message(error));
  }

  std::string path_;
  FileDescriptor fd_;
  libevdev* device_ = nullptr;
  bool syncing_ = false;
};

EvdevLayout Handle::layout() const {
  const auto has = [this](unsigned type, unsigned code) {
    return libevdev_has_event_code(device_, type, code) == 1;
  };
  const char* const name = libevdev_get_name(device_);
  EvdevLayout layout{.name = printable_line(name ? name : "event device"),
                     .constant = has(EV_FF, FF_CONSTANT),
                     .rumble = has(EV_FF, FF_RUMBLE),
                     .gain = has(EV_FF, FF_GAIN),
                     .autocenter = has(EV_FF, FF_AUTOCENTER),
                     .axes = {}};
  int buttons = 0;
  for (std::uint16_t code = BTN_MISC; code < KEY_OK && buttons < 2; ++code)
    if (has(EV_KEY, code) && ++buttons == 2) layout.second_button = code;
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

std::optional<input_event> Handle::place(std::uint16_t code) const {
  input_event event{};
  event.type = EV_ABS;
  event.code = code;
  int value = 0;
  if (!libevdev_fetch_event_value(device_, EV_ABS, code, &value)) return std::nullopt;
  event.value = value;
  return event;
}

std::optional<input_event> Handle::next() {
  for (;;) {
    input_event event;
    const int got = libevdev_next_event(
        device_, syncing_ ? LIBEVDEV_READ_FLAG_SYNC : LIBEVDEV_READ_FLAG_NORMAL, &event);
    if (got == -EAGAIN && syncing_) {
      syncing_ = false;
      continue;
    }
    if (got == -EAGAIN || got == -EINTR) return std::nullopt;
    if (got < 0) fail("read", -got);
    if (got == LIBEVDEV_READ_STATUS_SYNC) syncing_ = true;
    if (event.type == EV_ABS || event.type == EV_KEY) return event;
  }
}

/// Whether two effects feel the same.
bool is_same(const ff_effect& a, const ff_effect& b) noexcept {
  if (a.type != b.type || a.direction != b.direction) return false;
  if (a.type == FF_CONSTANT) return a.u.constant.level == b.u.constant.level;
  return a.u.rumble.strong_magnitude == b.u.rumble.strong_magnitude &&
         a.u.rumble.weak_magnitude == b.u.rumble.weak_magnitude;
}

class Stick : public Hardware {
 public:
  Stick(const std::string& path, EvdevParameters parameters, double rate)
      : handle_(path),
        parameters_(parameters),
        layout_(usable_layout(handle_.layout(), parameters_)),
        rate_(rate) {
    // A stick that is held says where it is. One that steers begins at rest: before the first event
    // the kernel says 0, which is an end of an axis from 0 to 255.
    for (const auto& axis : layout_.axes)
      if (const auto event = axis && layout_.constant ? handle_.place(axis->code) : std::nullopt)
        take_event(layout_, parameters_, *event, events_);
    if (!layout_.has_force()) return;
    if (layout_.autocenter) handle_.send(FF_AUTOCENTER, 0);  // a spring of the driver's own
    if (layout_.gain) handle_.send(FF_GAIN, 0xffff);
    force_ = effect_of({0, 0, 0});
    handle_.upload(force_);
    if (!layout_.constant) {
      snap_ = snap_effect();
      handle_.upload(snap_);
    }
    play();
  }

  hapgrid_device_greeting greeting() const override {
    return stick_greeting(layout_, parameters_, rate_);
  }

  void measure(hapgrid_device_state& state) override {
    while (const auto event = handle_.next()) take_event(layout_, parameters_, *event, events_);
    std::copy_n(events_.position, 3, state.position);
    state.flags = events_.flags;
  }

  /// Zero force goes at once; any other no sooner than the device can take it.
  void apply(const Vec3& force) override {
    if (!layout_.has_force()) return;
    const ff_effect wanted = effect_of(force);
    if (is_same(wanted, force_)) return;
    const std::int16_t id = force_.id;
    force_ = wanted;
    force_.id = id;
    pushes_ = force != Vec3{0, 0, 0};
    if (!pushes_ || Clock::now() >= rested_)
      upload();
    else
      is_waiting_ = true;
  }

  void snap() override {
    if (snap_.id >= 0) handle_.send(static_cast<std::uint16_t>(snap_.id), 1);
  }

  Clock::time_point due() const override {
    if (!pushes_) return Clock::time_point::max();
    return is_waiting_ ? std::min(rested_, played_ + kRepeat) : played_ + kRepeat;
  }

  void work() override {
    if (is_waiting_ && Clock::now() >= rested_) upload();
    if (Clock::now() >= played_ + kRepeat) play();
  }

  void let_go() override {
    if (!layout_.has_force()) return;
    const auto stop = [this] {
      for (const ff_effect* effect : {&force_, &snap_})
        if (effect->id >= 0) handle_.send(static_cast<std::uint16_t>(effect->id), 0);
    };
    try {
      apply({0, 0, 0});
    } catch (const DeviceError&) {
      stop();
      throw;
    }
    stop();
  }

 private:
  ff_effect effect_of(const Vec3& force) const {
    return layout_.constant ? constant_effect(force, parameters_)
                            : rumble_effect(force, parameters_);
  }
  void upload() {
    is_waiting_ = false;
    handle_.upload(force_);
    rested_ = Clock::now() + (layout_.constant ? kForceRest : kRumbleRest);
    if (pushes_ && Clock::now() >= played_ + kRepeat) play();
  }
  void play() {
    played_ = Clock::now();
    handle_.send(static_cast<std::uint16_t>(force_.id), 1);
  }

  Handle handle_;
  EvdevParameters parameters_;
  EvdevLayout layout_;
  double rate_;
  hapgrid_device_state events_{};  // where they have put the axes and buttons
  ff_effect force_ = snap_effect(), snap_ = snap_effect();  // with the id -1 until it is there
  bool pushes_ = false;      // the force is not zero: its effect is started again and again
  bool is_waiting_ = false;  // the force, until the device has rested
  Clock::time_point rested_, played_;
};

/// "KEY=VALUE" of play's settings. @throw Error
void set(const std::string& word, EvdevParameters& parameters) {
  const std::size_t equals = word.find('=');
  const std::string key = word.substr(0, equals);
  const char* at = word.data() + std::min(equals, word.size() - 1) + 1;
  const char* const end = word.data() + word.size();
  const auto number = [&](double& value) {
    const auto read = std::from_chars(at, end, value);
    if (read.ec != std::errc()) throw Error("no number: " + word);
    at = read.ptr == end ? end : read.ptr + 1;
  };
  if (key == "max_force")
    number(parameters.newtons);
  else if (key == "range")
    number(parameters.half_range);
  else if (key == "signs")
    number(parameters.signs[0]), number(parameters.signs[1]);
  else
    throw Error("unknown word: " + word);
}

std::string find(const AdapterWords& words) {
  const std::string which = words.words.empty() ? "" : words.words[0];
  return find_one_evdev(list_evdev(), parse_hid_match(which)).path;
}

std::unique_ptr<Hardware> open_stick(const AdapterWords& words) {
  EvdevParameters parameters;
  for (std::size_t i = 1; i < words.words.size(); ++i) set(words.words[i], parameters);
  return std::make_unique<Stick>(find(words), parameters, words.rate);
}

std::vector<ListedDevice> list() {
  std::vector<ListedDevice> listed;
  for (const EvdevInfo& info : list_evdev())
    listed.push_back({"evdev:" + info.path,
                      info.constant ? "force"
                      : info.rumble ? "rumble"
                                    : "-",
                      shown_name(info), may_open(info.path) ? "" : stick_permission(info)});
  return listed;
}

void release(const AdapterWords& words) {
  Handle handle(find(words));
  handle.stop_all();
}

}  // namespace

int main(int argc, char** argv) {
  return adapter_main(argc, argv,
                      {"[WHICH [max_force=N] [range=M] [signs=X,Y]]", open_stick, release, list});
}
