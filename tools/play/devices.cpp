#include "tools/play/devices.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cctype>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/device/keyboard.hpp"
#include "libcore/device/path.hpp"
#include "libcore/loop/mapping.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

enum class Argument { kNone, kNeeded, kMayBe };

struct Form {
  std::string_view kind;
  Argument argument;
  std::string_view shown;
};

/// The words of a command; blanks stand between them, and quotes mean nothing.
/// A character behind a backslash is part of its word, as a blank in a path.
std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words;
  bool in_word = false;
  for (std::size_t i = 0; i < command.size(); ++i) {
    const bool ends = std::isspace(static_cast<unsigned char>(command[i])) != 0;
    if (!ends && !in_word) words.emplace_back();
    in_word = !ends;
    if (command[i] == '\\' && i + 1 < command.size()) ++i;
    if (!ends) words.back() += command[i];
  }
  return words;
}

constexpr std::string_view kPath = "path", kKeys = "keys", kReplay = "replay", kEvdev = "evdev",
                           kProcess = "process";

constexpr Form kForms[] = {
    {kPath, Argument::kNeeded, "path:FILE"},
    {kKeys, Argument::kNone, "keys"},
    {kReplay, Argument::kNeeded, "replay:FILE"},
    {"hid", Argument::kNeeded, "hid:PROFILE"},
    {kEvdev, Argument::kMayBe, "evdev[:WHICH]"},
    {"spacemouse", Argument::kMayBe, "spacemouse[:WHICH]"},
    {kProcess, Argument::kNeeded, "process:COMMAND"},
};

/// Where keys begin to move the HIP.
Vec3 start_of(const PlaySettings& settings, const Box& box) {
  const Vec3 low = box.origin, high = box.high();
  Vec3 start;
  for (int a = 0; a < 3; ++a)
    start[a] = std::clamp((low[a] + high[a]) / 2 + settings.mapping.offset[a], low[a], high[a]);
  return start;
}

OpenDevice open_path(const std::string& file) {
  std::vector<DeviceInput> ticks = read_path(file);
  const std::size_t count = ticks.size();
  return {.device = std::make_unique<ReplayDevice>(std::move(ticks), "path"),
          .ticks = count,
          .session = {}};
}

OpenDevice open_replay(const std::string& file) {
  SessionReader session(file);
  std::vector<DeviceInput> ticks = load_recording(session);
  if (!session.ended_early().empty())
    say("play", format("{}: the session ended early, at {}", file, session.ended_early()));
  const std::size_t count = ticks.size();
  return {.device = std::make_unique<ReplayDevice>(std::move(ticks)),
          .ticks = count,
          .session = session.header()};
}

OpenDevice open_adapter(AdapterProgram program) {
  const rlimit no_core{0, 0};  // sockets stay open until a core file is written
  ::setrlimit(RLIMIT_CORE, &no_core);
  auto device = std::make_unique<ProcessDevice>(std::move(program));
  const ProcessDevice* const adapter = device.get();
  return {.device = std::move(device), .session = {}, .adapter = adapter};
}

}  // namespace

std::string own_program(const std::string& name) {
  const std::filesystem::path folder = own_folder();
  if (folder.empty()) throw Error("the folder of play is not known: is /proc mounted?");
  return folder / name;
}

DeviceChoice parse_device(const std::string& name) {
  const std::size_t colon = name.find(':');
  const bool given = colon != std::string::npos;
  const std::string argument = given ? name.substr(colon + 1) : "";
  std::string forms;
  for (const Form& form : kForms) {
    const bool fits = form.argument == Argument::kMayBe  ? given != argument.empty()
                      : form.argument == Argument::kNone ? !given
                                                         : !argument.empty();
    if (name.substr(0, colon) == form.kind && fits) {
      if (form.kind == kProcess && words_of(argument).empty())
        throw UsageError("--device: process: names no program");
      return {std::string(form.kind), argument};
    }
    forms += format("{}{}", forms.empty() ? "" : ", ", form.shown);
  }
  throw UsageError(format("--device: '{}' is not a device: {}", name, forms));
}

std::string input_file(const DeviceChoice& device) {
  return device.kind == kPath || device.kind == kReplay ? device.argument : "";
}

bool is_live(const DeviceChoice& device) { return input_file(device).empty(); }

bool has_adapter(const DeviceChoice& device) { return is_live(device) && device.kind != kKeys; }

std::string keys_of(const DeviceChoice& device) {
  if (device.kind != kKeys) return "";
  // A terminal has 80 columns.
  return "arrows: x, z  page up, down: y  + -: step  0: start  n: level  r: force  q: end";
}

AdapterProgram adapter_program(const DeviceChoice& choice, const PlaySettings& settings,
                               double rate_hz) {
  AdapterProgram program{.command = {}, .name = {}, .guard = own_program("hapgrid-guard")};
  if (choice.kind == kProcess) {
    program.command = words_of(choice.argument);
    for (const std::string& word : program.command)
      program.name += (program.name.empty() ? "process '" : " ") + word;
    program.name += "'";
    return program;
  }
  program.name = "hapgrid-" + choice.kind;
  program.command = {own_program(program.name)};
  if (rate_hz > 0) program.command.insert(program.command.end(), {"--rate", to_text(rate_hz)});
  program.command.push_back(choice.argument);
  if (choice.kind == kEvdev) {
    const EvdevSettings& evdev = settings.evdev;
    program.command.push_back("max_force=" + to_text(evdev.newtons));
    program.command.push_back("range=" + to_text(evdev.half_range));
    program.command.push_back(
        format("signs={},{}", to_text(evdev.signs[0]), to_text(evdev.signs[1])));
  }
  return program;
}

OpenDevice open_device(const DeviceChoice& device, const PlaySettings& settings, double rate_hz,
                       const Box& box) {
  if (device.kind == kPath) return open_path(device.argument);
  if (device.kind == kReplay) return open_replay(device.argument);
  if (device.kind != kKeys) return open_adapter(adapter_program(device, settings, rate_hz));
  return {.device = std::make_unique<KeyboardDevice>(box, start_of(settings, box), box.spacing / 2),
          .session = {}};
}

}  // namespace hapgrid
