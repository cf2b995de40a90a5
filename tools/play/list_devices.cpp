#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>
#include <system_error>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/model/process.hpp"
#include "tools/play/devices.hpp"
#include "tools/play/instead.hpp"

namespace hapgrid {

namespace fs = std::filesystem;

namespace {

/// What an adapter writes with --list. @throw Error
std::string list_of(Launcher& launcher, const std::string& adapter) try {
  ChildProcess child(launcher, {own_program(adapter), "--list"}, "");
  child.hang_up();
  while (child.pump(ChildProcess::Clock::time_point::max()) == ChildProcess::Event::kMoved) {
  }
  return std::string(child.rest());
} catch (const Error& e) {
  throw Error(format("{}: {}", adapter, e.what()));
}

/// With backslashes, as `process:` needs it where a path has blanks.
std::string as_word(const std::string& path) {
  std::string word;
  for (const char c : path) {
    if (c == '\\' || c == ' ') word += '\\';
    word += c;
  }
  return word;
}

struct Row {
  std::string device, feels, name;
};

/// What our adapters find. @param helps gets what keeps the user from opening devices
std::vector<Row> found(std::set<std::string>& helps) {
  std::vector<Row> rows;
  Launcher launcher;
  for (const char* adapter : {"hapgrid-hid", "hapgrid-spacemouse", "hapgrid-evdev"}) {
    std::istringstream lines(list_of(launcher, adapter));
    for (std::string line; std::getline(lines, line);) {
      std::istringstream fields(line);
      Row row;
      std::string help;
      std::getline(fields, row.device, '\t');
      std::getline(fields, row.feels, '\t');
      std::getline(fields, row.name, '\t');
      std::getline(fields, help);
      if (!help.empty()) helps.insert(format("{}: permission denied: {}", row.name, help));
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace

std::set<std::string> permissions_lacking() {
  std::set<std::string> helps;
  found(helps);
  return helps;
}

std::string devices_table() {
  std::vector<Row> rows{{"--device", "feels", "name"}};
  std::set<std::string> helps;
  for (Row& row : found(helps)) rows.push_back(std::move(row));
  const bool has_hardware = rows.size() > 1;
  std::error_code none;
  std::set<std::string> adapters;
  for (const auto& entry : fs::directory_iterator(own_folder() / "../devices", none))
    if (!entry.is_directory(none) && entry.path().extension() != ".toml")
      adapters.insert(fs::weakly_canonical(entry.path()).string());
  for (const std::string& adapter : adapters) {
    const bool is_python = fs::path(adapter).extension() == ".py";
    rows.push_back({format("process:{}{}", is_python ? "python3 " : "", as_word(adapter)), "force",
                    format("adapter {}", fs::path(adapter).stem().string())});
  }
  std::size_t width = 0;
  for (const Row& row : rows) width = std::max(width, row.device.size());
  std::string text;
  for (const Row& row : rows)
    text += format("{}  {}  {}\n", left(row.device, width), left(row.feels, 6), row.name);
  if (!has_hardware) text += "no HID device, SpaceMouse, gamepad, stick or wheel is connected\n";
  for (const std::string& help : helps) text += help + "\n";
  return printable_text(text);
}

}  // namespace hapgrid
