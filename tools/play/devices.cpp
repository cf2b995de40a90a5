#include "tools/play/devices.hpp"

#include <iostream>
#include <string_view>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/device/hid_bus.hpp"
#include "libcore/device/hid_describe.hpp"
#include "libcore/device/hid_device.hpp"
#include "libcore/device/keyboard.hpp"
#include "libcore/device/path.hpp"
#include "libcore/device/profile.hpp"
#include "libcore/device/replay.hpp"
#include "libcore/device/spacemouse.hpp"

namespace hapgrid {

namespace {

constexpr std::uint64_t kMaxProfileBytes = 1 << 20;

enum class Kind { kPath, kKeys, kReplay, kProfile, kPid, kSpaceMouse };
enum class Argument { kNone, kNeeded, kMayBe };

struct Form {
  const char* name;
  Kind kind;
  Argument argument;
  const char* shown;
};

constexpr Form kForms[] = {
    {"path", Kind::kPath, Argument::kNeeded, "path:FILE"},
    {"keys", Kind::kKeys, Argument::kNone, "keys"},
    {"replay", Kind::kReplay, Argument::kNeeded, "replay:FILE"},
    {"profile", Kind::kProfile, Argument::kNeeded, "profile:FILE"},
    {"pid", Kind::kPid, Argument::kMayBe, "pid[:WHICH]"},
    {"spacemouse", Kind::kSpaceMouse, Argument::kMayBe, "spacemouse[:WHICH]"},
};

struct Name {
  Kind kind;
  std::string argument;
};

std::optional<Name> parse(const std::string& name) {
  const std::size_t colon = name.find(':');
  const std::string argument = colon == name.npos ? "" : name.substr(colon + 1);
  for (const Form& form : kForms) {
    if (name.substr(0, colon) != form.name) continue;
    const bool given = colon != name.npos;
    if (given != !argument.empty() || (given && form.argument == Argument::kNone) ||
        (!given && form.argument == Argument::kNeeded))
      return std::nullopt;
    return Name{form.kind, argument};
  }
  return std::nullopt;
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

OpenDevice open_path(const std::string& file) {
  // new: a device is not moved, and open() makes it in place.
  auto path = std::unique_ptr<PathDevice>(new PathDevice(PathDevice::open(file)));
  const std::size_t ticks = path->size();
  return {.device = std::move(path), .live = false, .ticks = ticks, .session = {}};
}

OpenDevice open_replay(const std::string& file, double text_rate_hz) {
  const Recording recording = load_recording(file, text_rate_hz);
  std::vector<ReplayTick> ticks;
  ticks.reserve(recording.ticks.size());
  std::uint64_t next = recording.ticks.front().number;
  for (const RecordedTick& tick : recording.ticks) {
    ticks.push_back({.input = {.position = tick.hip,
                               .stalled = tick.stalled,
                               .clutch = tick.clutch,
                               .reset = tick.reset},
                     .missed = tick.number - next});
    next = tick.number + 1;
  }
  const std::size_t count = ticks.size();
  return {.device = std::make_unique<ReplayDevice>(std::move(ticks)),
          .live = false,
          .ticks = count,
          .session = recording.header};
}

std::unique_ptr<Device> open_profile(const std::string& file, HidGuard* guard) {
  Profile profile = read_profile(read_text(file, kMaxProfileBytes), file);
  const HidInfo info = find_one_hid(list_hid(), profile.match, "[match] serial or path in " + file);
  if (profile.has_usages())
    resolve_usages(profile, parse_hid_descriptor(read_report_descriptor(info.path)));
  return std::make_unique<HidDevice>(info.path,
                                     std::make_unique<ProfileProtocol>(std::move(profile)), guard);
}

/// Those of `devices` that have all that a PID joystick needs. What cannot be read is none.
std::vector<HidInfo> pid_devices(const std::vector<HidInfo>& devices) {
  std::vector<HidInfo> found;
  for (const HidInfo& info : devices) {
    try {
      find_pid_reports(parse_hid_descriptor(read_report_descriptor(info.path)));
      found.push_back(info);
    } catch (const Error&) {
    }
  }
  return found;
}

std::unique_ptr<Device> open_pid(const std::string& which, const PidParameters& parameters,
                                 HidGuard* guard) {
  const std::vector<HidInfo> all = list_hid();
  const HidMatch match = parse_hid_match(which);
  // A device that is named is opened, so that what it lacks is said.
  const HidInfo info =
      find_one_hid(which.empty() ? pid_devices(all) : all, match, "--device pid:WHICH");
  PidParameters named = parameters;
  named.name = shown_name(info);
  return std::make_unique<HidDevice>(
      info.path,
      std::make_unique<PidProtocol>(parse_hid_descriptor(read_report_descriptor(info.path)), named),
      guard);
}

std::unique_ptr<Device> open_spacemouse(const std::string& which) {
  std::vector<HidInfo> mice;
  for (const HidInfo& info : list_hid())
    if (is_spacemouse(info.vid, info.pid)) mice.push_back(info);
  const HidInfo info = find_one_hid(mice, parse_hid_match(which), "--device spacemouse:WHICH");
  return std::make_unique<HidDevice>(info.path,
                                     std::make_unique<SpaceMouseProtocol>(shown_name(info)));
}

}  // namespace

std::string device_mistake(const std::string& name) {
  if (parse(name)) return "";
  std::string forms;
  for (const Form& form : kForms) forms += (forms.empty() ? "" : ", ") + std::string(form.shown);
  return "'" + name + "' is not a device: " + forms;
}

std::string device_file(const std::string& name) {
  return is_live(name) ? "" : parse(name).value().argument;
}

bool is_live(const std::string& name) {
  const auto parsed = parse(name);
  return parsed && parsed->kind != Kind::kPath && parsed->kind != Kind::kReplay;
}

bool needs_guard(const std::string& name) {
  const auto parsed = parse(name);
  return parsed && (parsed->kind == Kind::kProfile || parsed->kind == Kind::kPid);
}

OpenDevice open_device(const PlayOptions& options, const Box& box, HidGuard* guard) {
  const Name name = parse(options.device).value();
  const auto live = [](std::unique_ptr<Device> device) {
    return OpenDevice{.device = std::move(device), .session = {}};
  };
  switch (name.kind) {
    case Kind::kPath:
      return open_path(name.argument);
    case Kind::kReplay:
      return open_replay(name.argument, options.rate_hz > 0 ? options.rate_hz : kUnpacedHz);
    case Kind::kKeys:
      return live(std::make_unique<KeyboardDevice>(keyboard_options(options, box)));
    case Kind::kProfile:
      return live(open_profile(name.argument, guard));
    case Kind::kPid:
      return live(open_pid(name.argument, options.pid, guard));
    case Kind::kSpaceMouse:
      return live(open_spacemouse(name.argument));
  }
  throw Error("no such device");
}

void print_devices() { std::cout << list_text(list_hid()); }

void print_descriptor(const std::string& which) {
  const HidInfo info = find_one_hid(list_hid(), parse_hid_match(which), "--dump-descriptor WHICH");
  const std::vector<std::uint8_t> bytes = read_report_descriptor(info.path);
  std::cout << shown_name(info) << " at " << info.path << "\n"
            << hex_text(bytes) << describe(parse_hid_descriptor(bytes));
}

}  // namespace hapgrid
