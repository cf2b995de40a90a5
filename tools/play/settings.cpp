#include "tools/play/settings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <numeric>
#include <sstream>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"
#include "libcore/base/toml.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

template <double SafetyLimits::*kMember>
std::span<double> limit(PlaySettings& s) {
  return {&(s.safety.*kMember), 1};
}

constexpr Setting kSettings[] = {
    {"--gain", "FACTOR", 0, 1e12, "Newtons felt for a newton of the model (default: 1)",
     limit<&SafetyLimits::gain>},
    {"--max-force", "N", 0, 1e6, "Largest force (default: 3, or the device's own smaller limit)",
     limit<&SafetyLimits::max_force>},
    {"--scale", "UNITS/M", 0, 1e15,
     "Model units per metre of the hand; 0: the device's reach fills\n"
     "the box (default: 0)",
     [](PlaySettings& s) { return std::span(&s.mapping.scale, 1); }},
    {"safety.slew", "N/ms", 0, kInf, "Largest change of the force in a millisecond",
     limit<&SafetyLimits::slew>},
    {"safety.ramp", "ms", 0, 1e6, "Time in which the force comes back after a zero",
     limit<&SafetyLimits::ramp_ms>},
    {"safety.max_speed", "m/s", 0, kInf, "A faster hand gets zero force; needs a scale",
     limit<&SafetyLimits::max_speed>},
    {"safety.buzz_force", "N", 0, kInf, "Swings of the force count from this size on",
     limit<&SafetyLimits::buzz_force>},
    {"safety.buzz_rate", "1/s", 0, kInf, "More swings are damped; twice as many give zero",
     limit<&SafetyLimits::buzz_rate>},
    {"safety.fade", "cells", 0, kInf, "Length of the fade outside the box; 0: no fade",
     limit<&SafetyLimits::fade_cells>},
    {"safety.watchdog", "ticks", 0, kInf, "So many missed ticks give zero force",
     limit<&SafetyLimits::watchdog_ticks>},
    {"safety.reserve", "mJ", 0, kInf, "Given at most beyond what was stored",
     limit<&SafetyLimits::reserve>},
    {"safety.encoder", "m", 0, 0.1, "The device's positions come in such steps",
     limit<&SafetyLimits::encoder>},
    {"safety.delay", "ticks", 0, kMaxTankDelay, "From when a force is sent until it acts",
     limit<&SafetyLimits::delay_ticks>},
    {"mapping.offset", "units", -1e15, 1e15, "Middle of the reach, from the middle of the box",
     [](PlaySettings& s) { return std::span<double>(s.mapping.offset); }},
    {"mapping.speed", "units/s", 0, 1e15, "Of a SpaceMouse's HIP; 0: the box in 4 s",
     [](PlaySettings& s) { return std::span(&s.mapping.speed, 1); }},
    {"keys.step", "units", 0, 1e15, "A key moves the HIP so far; 0: half the spacing",
     [](PlaySettings& s) { return std::span(&s.key_step, 1); }},
    {"pid.newtons", "N", 1e-6, 1e6, "What the joystick gives at most on each axis",
     [](PlaySettings& s) { return std::span(&s.pid.newtons, 1); }},
    {"pid.range", "m", 1e-6, 1e3, "From the middle of each axis to its end",
     [](PlaySettings& s) { return std::span(&s.pid.half_range, 1); }},
    {"pid.signs", "+1/-1", -1, 1, "Signs of forces to the right, towards the user",
     [](PlaySettings& s) { return std::span<double>(s.pid.signs); }},
    {"loop.spin", "us", 0, 1000, "The end of each wait is spent awake: less late",
     [](PlaySettings& s) { return std::span(&s.spin_us, 1); }},
    {"imd.wait", "s", 0, 86400, "Longest wait for a viewer before the first tick",
     [](PlaySettings& s) { return std::span(&s.imd_wait_s, 1); }},
};

bool is_option(const Setting& setting) { return setting.name[0] == '-'; }

std::string range(const Setting& s) { return to_text(s.low) + " to " + to_text(s.high); }
std::string bounds(const Setting& s) { return " from " + range(s) + " " + s.unit; }

/// How many letters differ: Levenshtein's distance.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t corner = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = corner + (a[i] != b[j]);
      corner = row[j + 1];
      row[j + 1] = std::min({changed, corner + 1, row[j] + 1});
    }
  }
  return row.back();
}

std::string unknown_key(const std::string& key) {
  std::string nearest;
  std::size_t least = 3;  // more wrong letters are another word
  for (const Setting& setting : kSettings) {
    const std::string name = setting.name;
    const std::string last = name.substr(name.find_first_of(".-") + 1);
    const std::size_t far = std::min(distance(key, name), distance(key, last));
    if (far < least) nearest = name;
    least = std::min(least, far);
  }
  return "unknown key '" + key + "'" +
         (nearest.empty() ? "; play --help has a table of keys"
                          : "; did you mean '" + nearest + "'?");
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

/// Takes `key = node`. @return what is wrong with it, empty when nothing is
std::string take(const std::string& key, const toml::node& node, GivenSettings& given) {
  const auto setting = std::find_if(std::begin(kSettings), std::end(kSettings),
                                    [&](const Setting& s) { return s.name == key; });
  if (setting == std::end(kSettings)) return unknown_key(key);
  PlaySettings defaults;
  const std::size_t count = setting->values(defaults).size();
  const std::vector<double> values = read_numbers(node);
  const auto good = [&](double v) { return v >= setting->low && v <= setting->high; };
  if (values.size() != count || !std::all_of(values.begin(), values.end(), good))
    return key + " must be " +
           (count == 1 ? "a number" : std::to_string(count) + " numbers in [ ]") + bounds(*setting);
  given.emplace_back(setting, values);
  return "";
}

void set(const std::string& text, GivenSettings& given) {
  const std::size_t equals = text.find('=');
  std::string mistake = "'" + text + "' is not like KEY=VALUE";
  try {
    const TomlFile value("value = " + text.substr(equals + 1), "");
    if (equals != std::string::npos && value.root().size() == 1)
      mistake = take(text.substr(0, equals), *value.root().get("value"), given);
  } catch (const Error&) {  // VALUE is not one
  }
  if (!mistake.empty()) throw UsageError("--set: " + mistake);
}

/// Takes the keys of a table, which begin with `prefix`, and of the tables in it. @throw Error
void take_all(const TomlFile& file, const toml::table& table, const std::string& prefix,
              GivenSettings& given) {
  for (const auto& [k, node] : table) {
    const std::string key = prefix + std::string(k.str());
    if (const toml::table* inner = node.as_table()) {
      take_all(file, *inner, key + ".", given);
    } else if (const std::string mistake = take(key, node, given); !mistake.empty()) {
      file.fail(node, mistake);
    }
  }
}

/// The value of an option, as the command line would have it.
std::string word(const TomlFile& file, const toml::node& node, const std::string& key) {
  if (node.is_string()) return **node.as_string();
  if (node.is_boolean()) return **node.as_boolean() ? "true" : "false";
  if (node.is_integer()) return std::to_string(**node.as_integer());
  if (node.is_floating_point()) return to_text(**node.as_floating_point());
  file.fail(node, "play." + key + " must be a number, a text, true or false, or an array");
}

std::vector<ConfigEntry> read_play(const TomlFile& file, const CommandLine& app,
                                   GivenSettings& given) {
  std::vector<ConfigEntry> items;
  if (!file.root().contains("play")) return items;
  for (const auto& [k, node] : file.table(file.root(), "play")) {
    ConfigEntry item;
    item.name = k.str();
    if (const toml::table* inner = node.as_table()) {
      take_all(file, *inner, item.name + ".", given);
      continue;
    }
    if (item.name == "config" || item.name == "set" || !app.has("--" + item.name))
      file.fail(node, unknown_key(item.name));
    if (const toml::array* entries = node.as_array()) {
      for (const toml::node& entry : *entries) item.values.push_back(word(file, entry, item.name));
    } else {
      item.values.push_back(word(file, node, item.name));
    }
    items.push_back(item);
  }
  return items;
}

}  // namespace

PlaySettings changed(PlaySettings settings, const GivenSettings& given) {
  for (const auto& [setting, values] : given)
    std::copy(values.begin(), values.end(), setting->values(settings).begin());
  return settings;
}

void add_settings(CommandLine& app, GivenSettings& given) {
  // Other filters read the other tables of such a file.
  app.add_config(
      "--config",
      "Take options and settings from the table [play] of a TOML\n"
      "file, such as the MODEL.toml; the command line counts more",
      [&](const std::string& text) { return read_play(TomlFile(text, "--config"), app, given); });
  for (const Setting& setting : kSettings) {
    if (!is_option(setting)) continue;
    app.add(
           setting.name,
           [&](const std::string& text) {
             given.emplace_back(&setting, std::vector{std::strtod(text.c_str(), nullptr)});
           },
           setting.meaning)
        .type(setting.unit)
        .within(setting.low, setting.high, "a number" + bounds(setting));
  }
  app.add(
         "--set", [&](const std::string& text) { set(text, given); },
         "Change a setting of the table below: --set safety.ramp=200 or\n"
         "--set 'mapping.offset=[0.1,0,0]'; repeatable")
      .type("KEY=VALUE")
      .repeatable();
}

std::string settings_help() {
  const auto padded = [](std::string text, std::size_t width) {
    text.resize(std::max(width, text.size()), ' ');
    return text + " ";
  };
  std::string help = "  " + padded("KEY", 18) + padded("UNIT", 7) + padded("DEFAULT", 7) +
                     padded("RANGE", 15) + "MEANING\n";
  for (const Setting& setting : kSettings) {
    if (is_option(setting)) continue;
    PlaySettings defaults;
    std::string values;
    for (const double value : setting.values(defaults))
      values += (values.empty() ? "" : ",") + to_text(value);
    help += "  " + padded(setting.name, 18) + padded(setting.unit, 7) + padded(values, 7) +
            padded(range(setting), 15) + setting.meaning + "\n";
  }
  return help;
}

}  // namespace hapgrid
