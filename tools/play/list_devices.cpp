#include "tools/play/list_devices.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

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

namespace hapgrid {

namespace fs = std::filesystem;

namespace {

/// What an adapter writes with --list. @throw Error
std::string list_of(const fs::path& adapter) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category());
  const FileDescriptor from(ends[0]);
  FileDescriptor to(ends[1]);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, to.get(), STDOUT_FILENO);
  std::string program = adapter.string(), option = "--list";
  char* const arguments[] = {program.data(), option.data(), nullptr};
  pid_t pid = -1;
  const int error = ::posix_spawn(&pid, arguments[0], &actions, nullptr, arguments, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw Error(
        format("{}: cannot be started: {}", program, std::generic_category().message(error)));
  to = FileDescriptor();
  std::string text;
  char part[4096];
  for (ssize_t got; (got = ::read(from.get(), part, sizeof part)) > 0;)
    text.append(part, static_cast<std::size_t>(got));
  ::waitpid(pid, nullptr, 0);
  return text;
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

fs::path adapters_folder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

/// What our adapters find. @param helps gets what keeps the user from opening devices
std::vector<Row> found(std::set<std::string>& helps) {
  std::vector<Row> rows;
  for (const char* adapter : {"hapgrid-hid", "hapgrid-spacemouse", "hapgrid-evdev"}) {
    std::istringstream lines(list_of(adapters_folder() / adapter));
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
  const fs::path folder = adapters_folder();
  std::vector<Row> rows{{"--device", "feels", "name"}};
  std::set<std::string> helps;
  for (Row& row : found(helps)) rows.push_back(std::move(row));
  const bool has_hardware = rows.size() > 1;
  std::error_code none;
  std::set<std::string> adapters;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "../devices", none))
    if (entry.path().extension() != ".toml")
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
