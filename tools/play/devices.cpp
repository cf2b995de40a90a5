#include "tools/play/devices.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/device/evdev_bus.hpp"
#include "libcore/device/evdev_handle.hpp"
#include "libcore/device/hand.hpp"
#include "libcore/device/hid_bus.hpp"
#include "libcore/device/hid_device.hpp"
#include "libcore/device/keyboard.hpp"
#include "libcore/device/path.hpp"
#include "libcore/device/process_device.hpp"
#include "libcore/device/profile.hpp"
#include "libcore/device/replay.hpp"
#include "libcore/device/spacemouse.hpp"
#include "libcore/haptic/mapping.hpp"
#include "tools/common/definition.hpp"
#include "tools/common/tool.hpp"
#include "tools/play/simulation.hpp"

namespace hapgrid {

namespace {

constexpr std::uint64_t kMaxProfileBytes = 1 << 20;

enum class Argument { kNone, kNeeded, kMayBe };

struct Form {
  const char* name;
  Argument argument;
  const char* shown;
  DeviceChoice (*make)(const std::string& argument);
};

template <class Choice>
DeviceChoice make(const std::string& argument) {
  return Choice{argument};
}

/// A pipe with a name has a hand at its other end. One without, as from `path:<(command)`, has a
/// whole path, and its name is a link.
DeviceChoice make_path(const std::string& argument) {
  std::error_code ignored;  // what is not there is refused when it is opened
  if (std::filesystem::symlink_status(argument, ignored).type() == std::filesystem::file_type::fifo)
    return HandPipe{argument};
  return PathFile{argument};
}

/// The words of the command; blanks stand between them, and quotes mean nothing.
DeviceChoice make_process(const std::string& argument) {
  AdapterProcess process;
  std::istringstream words(argument);
  for (std::string word; words >> word;) process.command.push_back(word);
  if (process.command.empty()) throw UsageError("--device: process: names no program");
  return process;
}

constexpr Form kForms[] = {
    {"path", Argument::kNeeded, "path:FILE", make_path},
    {"keys", Argument::kNone, "keys",
     [](const std::string&) { return DeviceChoice(TerminalKeys()); }},
    {"replay", Argument::kNeeded, "replay:FILE", make<ReplayFile>},
    {"sim", Argument::kNeeded, "sim:FILE", make<SimulationFile>},
    {"profile", Argument::kNeeded, "profile:FILE", make<ProfileFile>},
    {"evdev", Argument::kMayBe, "evdev[:WHICH]", make<EvdevStick>},
    {"spacemouse", Argument::kMayBe, "spacemouse[:WHICH]", make<SpaceMouse>},
    {"process", Argument::kNeeded, "process:COMMAND", make_process},
};

HipRange hip_range(const PlaySettings& settings, const Box& box) {
  HipRange range;
  range.low = box.position({0, 0, 0});
  range.high = box.position({box.counts[0] - 1, box.counts[1] - 1, box.counts[2] - 1});
  for (int a = 0; a < 3; ++a)
    range.start[a] = std::clamp((range.low[a] + range.high[a]) / 2 + settings.mapping.offset[a],
                                range.low[a], range.high[a]);
  return range;
}

OpenDevice open_path(const std::string& file) {
  // new: a device is not moved, and open() makes it in place.
  auto path = std::unique_ptr<PathDevice>(new PathDevice(PathDevice::open(file)));
  const std::size_t ticks = path->size();
  return {.device = std::move(path), .ticks = ticks, .session = {}};
}

OpenDevice open_replay(const std::string& file, double text_rate_hz) {
  const Recording recording = load_recording(file, text_rate_hz);
  if (!recording.ended_early.empty())
    say("play", format("{}: the session ended early, at {}", file, recording.ended_early));
  std::vector<DeviceInput> ticks;
  ticks.reserve(recording.ticks.size());
  std::uint64_t next = recording.ticks.front().number;
  for (const RecordedTick& tick : recording.ticks) {
    ticks.push_back({.position = tick.hip,
                     .stalled = tick.stalled,
                     .clutch = tick.clutch,
                     .reset = tick.reset,
                     .begins = tick.begins,
                     .missed = tick.number - next,
                     .slew_ns = tick.slew_ns});
    next = tick.number + 1;
  }
  const std::size_t count = ticks.size();
  return {.device = std::make_unique<ReplayDevice>(std::move(ticks)),
          .ticks = count,
          .session = recording.header};
}

OpenDevice open_simulation(const std::string& file, double rate_hz, const MappingOptions& mapping,
                           const Box& box) {
  const Simulation simulation = read_simulation(file, rate_hz);
  OpenDevice open{.device = {}, .session = {}, .wants_truth = simulation.truth};
  const Mapping map(mapping, SimulatedDevice::info(simulation.device), box);
  auto device = simulated_device(simulation, map, box);
  open.simulated = device.get();
  open.device = std::move(device);
  return open;
}

std::unique_ptr<Device> open_profile(const std::string& file, HidGuard& guard) {
  Profile profile = read_profile(read_toml(file, kMaxProfileBytes), file);
  const HidInfo info =
      find_one_hid(list_hid(), profile.match, format("[match] serial or path in {}", file));
  return std::make_unique<HidDevice>(info.path,
                                     std::make_unique<ProfileProtocol>(std::move(profile)), &guard);
}

std::unique_ptr<Device> open_evdev(const std::string& which, const EvdevParameters& parameters,
                                   HidGuard& guard) {
  const std::string path = find_one_evdev(list_evdev(), parse_hid_match(which)).path;
  auto protocol = std::make_unique<EvdevProtocol>(EvdevHandle(path).layout(), parameters);
  return std::make_unique<HidDevice>(path, std::move(protocol), &guard);
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

DeviceChoice parse_device(const std::string& name) {
  const std::size_t colon = name.find(':');
  const bool given = colon != std::string::npos;
  const std::string argument = given ? name.substr(colon + 1) : "";
  std::string forms;
  for (const Form& form : kForms) {
    const bool fits = form.argument == Argument::kMayBe  ? given != argument.empty()
                      : form.argument == Argument::kNone ? !given
                                                         : !argument.empty();
    if (name.substr(0, colon) == form.name && fits) return form.make(argument);
    forms += format("{}{}", forms.empty() ? "" : ", ", form.shown);
  }
  throw UsageError(format("--device: '{}' is not a device: {}", name, forms));
}

std::string input_file(const DeviceChoice& device) {
  if (const auto* path = std::get_if<PathFile>(&device)) return path->file;
  if (const auto* hand = std::get_if<HandPipe>(&device)) return hand->pipe;
  if (const auto* replay = std::get_if<ReplayFile>(&device)) return replay->file;
  if (const auto* simulation = std::get_if<SimulationFile>(&device)) return simulation->file;
  return "";
}

bool is_live(const DeviceChoice& device) {
  return std::holds_alternative<HandPipe>(device) || input_file(device).empty();
}

std::string keys_of(const DeviceChoice& device) {
  if (!std::holds_alternative<TerminalKeys>(device)) return "";
  return "arrows: x, z   page up, down: y   + -: step   0: start   r: force back   q: end";
}

DeviceGuard::DeviceGuard(const DeviceChoice& device) {
  const bool is_hid =
      std::holds_alternative<ProfileFile>(device) || std::holds_alternative<EvdevStick>(device);
  const auto* adapter = std::get_if<AdapterProcess>(&device);
  if (!is_hid && !adapter) return;
  const rlimit no_core{0, 0};  // the guard would wait until a core file is written
  ::setrlimit(RLIMIT_CORE, &no_core);
  if (is_hid) hid.emplace();
  if (adapter) process.emplace(adapter->command);
}

OpenDevice open_device(const DeviceChoice& device, const PlaySettings& settings, double virtual_hz,
                       const Box& box, DeviceGuard& guard) {
  struct Open {
    const PlaySettings& settings;
    double virtual_hz;
    const Box& box;
    DeviceGuard& guard;

    static OpenDevice live(std::unique_ptr<Device> device) {
      return {.device = std::move(device), .session = {}};
    }
    OpenDevice operator()(const PathFile& path) const { return open_path(path.file); }
    OpenDevice operator()(const HandPipe& hand) const {
      return live(std::make_unique<HandDevice>(hand.pipe, hip_range(settings, box)));
    }
    OpenDevice operator()(const ReplayFile& replay) const {
      return open_replay(replay.file, virtual_hz);
    }
    OpenDevice operator()(const SimulationFile& simulation) const {
      return open_simulation(simulation.file, virtual_hz, settings.mapping, box);
    }
    OpenDevice operator()(const TerminalKeys&) const {
      return live(std::make_unique<KeyboardDevice>(hip_range(settings, box), box.spacing / 2));
    }
    OpenDevice operator()(const ProfileFile& profile) const {
      return live(open_profile(profile.file, *guard.hid));
    }
    OpenDevice operator()(const EvdevStick& stick) const {
      return live(open_evdev(stick.which, settings.evdev, *guard.hid));
    }
    OpenDevice operator()(const SpaceMouse& mouse) const {
      return live(open_spacemouse(mouse.which));
    }
    OpenDevice operator()(const AdapterProcess&) const {
      auto device = std::make_unique<ProcessDevice>(*guard.process);
      const double rate_hz = device->rate_hz();
      return {.device = std::move(device), .session = {}, .rate_hz = rate_hz};
    }
  };
  return std::visit(Open{settings, virtual_hz, box, guard}, device);
}

void print_devices() {
  std::cout << printable_text(list_text(list_hid()) + list_text(list_evdev()));
}

}  // namespace hapgrid
