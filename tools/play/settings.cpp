#include "tools/play/settings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <sstream>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/base/toml.hpp"
#include "tools/common/spelling.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

template <double SafetyLimits::*kMember>
std::span<double> limit(PlaySettings& s) {
  return {&(s.safety.*kMember), 1};
}

using From = FromFile;

constexpr Setting kSettings[] = {
    {"--gain", "FACTOR", 0, 1e12, From::kLower,
     "Force that the hand feels for each newton of the model, in newtons. Default: 1.",
     limit<&SafetyLimits::gain>},
    {"--max-force", "N", 0, 1e6, From::kLower,
     "Largest force in newtons. Default: 3, or the device's own smaller limit.",
     limit<&SafetyLimits::max_force>},
    {"--scale", "UNITS/M", 0, 1e15, From::kFree,
     "Length in the model's units for each metre of the hand's motion; with 0 the device's reach "
     "fills the box. Default: 0.",
     [](PlaySettings& s) { return std::span(&s.mapping.scale, 1); }},
    {"safety.ramp", "ms", 0, 1e6, From::kHigher,
     "Time in which the force comes back after it was set to zero.", limit<&SafetyLimits::ramp_ms>},
    {"safety.reserve", "mJ", 0, kInf, From::kLower,
     "Largest energy that the device may give beyond what the hand has put in; inf: no limit.",
     limit<&SafetyLimits::reserve>},
    {"safety.encoder", "m", 0, 0.1, From::kHigher, "Steps in which the device measures positions.",
     limit<&SafetyLimits::encoder>},
    {"safety.delay", "ticks", 0, kMaxTankDelay, From::kHigher,
     "Time from sending a force until it acts.", limit<&SafetyLimits::delay_ticks>},
    {"mapping.offset", "units", -1e15, 1e15, From::kFree,
     "Middle of the device's reach, from the middle of the box.",
     [](PlaySettings& s) { return std::span<double>(s.mapping.offset); }},
    {"mapping.push", "", -1, 1, From::kNo,
     "Signs of the force along the device's own axes: -1 where it pushes the wrong way.",
     [](PlaySettings& s) { return std::span<double>(s.mapping.push); }},
    {"mapping.speed", "units/s", 0, 1e15, From::kFree,
     "Speed of a steered HIP; 0: it crosses the box in 4 s.",
     [](PlaySettings& s) { return std::span(&s.mapping.speed, 1); }},
    {"evdev.max_force", "N", 1e-6, 1e6, From::kNo,
     "Force of the strongest effect, or of full rumble.",
     [](PlaySettings& s) { return std::span(&s.evdev.newtons, 1); }},
    {"evdev.range", "m", 1e-6, 1e3, From::kNo,
     "Way of the hand from the middle of an axis to its end.",
     [](PlaySettings& s) { return std::span(&s.evdev.half_range, 1); }},
    {"evdev.signs", "", -1, 1, From::kNo,
     "Signs of the force along x and y: -1 if the device pushes in the wrong direction, 0 for y on "
     "a "
     "steering wheel.",
     [](PlaySettings& s) { return std::span<double>(s.evdev.signs); }},
    {"loop.spin", "µs", 0, 1000, From::kNo,
     "Busy wait at the end of each tick, which makes the loop more punctual and costs processor "
     "time.",
     [](PlaySettings& s) { return std::span(&s.spin_us, 1); }},
};

bool is_option(const Setting& setting) { return setting.name[0] == '-'; }

std::string bounds(const Setting& s) {
  return format(" from {} to {}{}{}", to_text(s.low), to_text(s.high), *s.unit ? " " : "", s.unit);
}

std::string unknown_key(const std::string& key) {
  // A key may be meant by its last part alone.
  std::vector<std::string> known, meant;
  for (const Setting& setting : kSettings) {
    const std::string name = setting.name;
    const std::string last = name.substr(is_option(setting) ? 2 : name.find('.') + 1);
    known.insert(known.end(), {name, last});
    meant.insert(meant.end(), 2, is_option(setting) ? last : name);
  }
  const auto near = nearest(key, known);
  return format(
      "unknown key '{}'; {}", key,
      near ? format("did you mean '{}'?", meant[*near]) : "play --help has a table of keys");
}

std::vector<double> read_numbers(const toml::node& node) {
  std::vector<double> numbers;
  const auto add = [&](const toml::node& entry) {
    const auto value = entry.value<double>();  // whole numbers, too
    numbers.push_back(entry.is_number() && value ? *value : std::nan(""));
  };
  if (const toml::array* entries = node.as_array())
    for (const toml::node& entry : *entries) add(entry);
  else
    add(node);
  return numbers;
}

/// Nothing when there is no such setting.
const Setting* find_setting(const std::string& name) {
  const auto found = std::find_if(std::begin(kSettings), std::end(kSettings),
                                  [&](const Setting& s) { return s.name == name; });
  return found == std::end(kSettings) ? nullptr : &*found;
}

/// Adds `node` to what is given. @return what is wrong with it, empty when nothing is
std::string parse_setting(const Setting& setting, const toml::node& node, GivenSettings& given) {
  PlaySettings defaults;
  const std::size_t count = setting.values(defaults).size();
  const std::vector<double> values = read_numbers(node);
  const auto good = [&](double v) { return v >= setting.low && v <= setting.high; };
  if (values.size() != count || !std::all_of(values.begin(), values.end(), good))
    return format("{} must be {}{}", setting.name,
                  count == 1 ? "a number" : format("{} numbers in [ ]", count), bounds(setting));
  given.emplace_back(&setting, values);
  return "";
}

/// Reads the table [play] of a file. One with other tables, as a definition, may be a stranger's.
class PlayTable {
 public:
  PlayTable(const std::string& text, const CommandLine& app, PlayFile& into)
      : file_(text, "--config"), app_(app), into_(into) {}

  /// @throw Error naming the first key that a file cannot set
  void read() {
    if (!file_.root().contains("play")) return;
    for (const auto& [k, node] : file_.table(file_.root(), "play")) {
      const std::string key(k.str());
      if (const toml::table* inner = node.as_table())
        read_inner(*inner, key + ".");
      else if (key == "axes")
        read_axes_key(node);
      else
        read_number("--" + key, key, node);
    }
  }

 private:
  void read_inner(const toml::table& table, const std::string& prefix) {
    for (const auto& [k, node] : table) {
      const std::string key = prefix + std::string(k.str());
      if (const toml::table* inner = node.as_table())
        read_inner(*inner, key + ".");
      else
        read_number(key, key, node);
    }
  }

  void read_axes_key(const toml::node& node) {
    into_.axes = file_.text(node, "axes");
    if (!read_axes(into_.axes))
      file_.fail(node, format("axes: '{}' is not like -z,x,y", into_.axes));
  }

  /// @param name of the setting or option. @param key as the file has it.
  void read_number(const std::string& name, const std::string& key, const toml::node& node) {
    const Setting* const setting = find_setting(name);
    if (!setting && app_.has(name))
      file_.fail(node, format("{} cannot be set by a file, only by the command line", key));
    if (!setting) file_.fail(node, unknown_key(key));
    if (const std::string mistake = parse_setting(*setting, node, into_.given); !mistake.empty())
      file_.fail(node, mistake);
    const bool own = file_.root().size() == 1;  // nothing but [play]
    if (own && !is_option(*setting)) return;
    if (setting->from_file == From::kNo)
      file_.fail(node, format("{} can only be set by a file that has the table [play] alone", key));
    PlaySettings defaults;
    const double usual = setting->values(defaults)[0];
    const double value = into_.given.back().second[0];
    const bool lower = setting->from_file == From::kLower && value > usual;
    const bool higher = setting->from_file == From::kHigher && value < usual;
    const std::string unit = name == "--gain" ? "" : std::string(" ") + setting->unit;
    if (lower || higher)
      file_.fail(node, format("{} = {}: {} can only set {}{} or {}; {} can set {}", key,
                              to_text(value), is_option(*setting) ? "a file" : "this file",
                              to_text(usual), unit, lower ? "less" : "more",
                              is_option(*setting) ? "the command line"
                                                  : "one that has the table [play] alone",
                              lower ? "more" : "less"));
  }

  TomlFile file_;
  const CommandLine& app_;
  PlayFile& into_;
};

/// The largest file of --config: other filters' tables may be in it, too.
constexpr std::uint64_t kMaxConfigBytes = 16 << 20;

/// @throw UsageError
void read_config(const std::string& name, const CommandLine& app, PlayFile& file) {
  file = {.name = name};
  try {
    PlayTable(read_regular_text(name, kMaxConfigBytes), app, file).read();
  } catch (const Error& e) {
    throw UsageError(e.what());
  } catch (const std::system_error& e) {
    throw UsageError(std::string("--config: ") + e.what());
  }
}

}  // namespace

PlaySettings changed(PlaySettings settings, const GivenSettings& given) {
  for (const auto& [setting, values] : given)
    std::copy(values.begin(), values.end(), setting->values(settings).begin());
  return settings;
}

std::optional<Axes> read_axes(const std::string& text) {
  std::istringstream words(text);
  std::string word;
  Axes read{};
  int count = 0;
  std::string used;
  for (; std::getline(words, word, ','); ++count) {
    if (count == 3) return std::nullopt;
    const double sign = word[0] == '-' ? -1 : 1;
    if (word[0] == '-' || word[0] == '+') word.erase(0, 1);
    if (word.size() != 1 || word[0] < 'x' || word[0] > 'z') return std::nullopt;
    if (used.find(word) != std::string::npos) return std::nullopt;
    used += word;
    read[count][word[0] - 'x'] = sign;
  }
  if (count != 3) return std::nullopt;
  return read;
}

std::string file_text(const PlayFile& file, const GivenSettings& given) {
  std::string text;
  const auto add = [&](std::string_view key, const std::string& value) {
    text += format("{}{} = {}", text.empty() ? "" : ", ", key, value);
  };
  for (const auto& [setting, values] : file.given) {
    if (std::any_of(given.begin(), given.end(),
                    [setting = setting](const auto& other) { return other.first == setting; }))
      continue;
    std::string numbers;
    for (const double value : values) numbers += (numbers.empty() ? "" : ",") + to_text(value);
    if (values.size() > 1) numbers = format("[{}]", numbers);
    add(std::string_view(setting->name).substr(is_option(*setting) ? 2 : 0), numbers);
  }
  if (!file.axes.empty()) add("axes", file.axes);
  return format("{} sets {}", file.name, text.empty() ? "nothing" : text);
}

void add_settings(CommandLine& app, GivenSettings& given, PlayFile& file) {
  // Other filters read the other tables of such a file.
  app.add(
         "--config", [&](const std::string& name) { read_config(name, app, file); },
         "TOML file whose table [play] has settings: gain, max-force, scale and those of the table "
         "below. Options on the command line override the file.")
      .type("FILE");
  for (const Setting& setting : kSettings) {
    if (!is_option(setting)) continue;
    app.add(
           setting.name,
           [&](const std::string& text) {
             given.emplace_back(&setting, std::vector{std::strtod(text.c_str(), nullptr)});
           },
           setting.meaning)
        .type(setting.unit)
        .within(setting.low, setting.high, format("a number{}", bounds(setting)));
  }
}

std::string settings_help() {
  std::string help =
      "  axes              Device's axes (x to the right, y away from the user, z up) that the "
      "box's "
      "x, y and z follow, as in \"-z,x,y\". Default: \"x,y,z\".\n";
  for (const Setting& setting : kSettings) {
    if (is_option(setting)) continue;
    PlaySettings defaults;
    std::string values;
    for (const double value : setting.values(defaults))
      values += (values.empty() ? "" : ",") + to_text(value);
    help += format("  {} {} Default: {}{}{}.\n", left(setting.name, 17), setting.meaning, values,
                   *setting.unit ? " " : "", setting.unit);
  }
  return help;
}

}  // namespace hapgrid
