#include "libcore/base/memory_use.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace hapgrid {

namespace {

std::uint64_t page() { return static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)); }

/// Resident bytes of the process whose file `stat` is given, if it belongs to the group.
std::uint64_t member_bytes(const std::filesystem::path& stat, pid_t group) {
  constexpr int kGroupField = 2, kResidentField = 21;  // behind the name: proc(5)
  std::ifstream file(stat);
  std::string text;
  std::getline(file, text);
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return 0;
  std::istringstream fields(text.substr(name_end + 1));
  std::string field;
  for (int k = 0; fields >> field; ++k) {
    if (k == kGroupField && field != std::to_string(group)) return 0;
    if (k == kResidentField) return std::stoull(field) * page();
  }
  return 0;
}

}  // namespace

std::uint64_t memory_of_this_process() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * page();
}

std::uint64_t memory_of_group(pid_t group) {
  std::uint64_t sum = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") == std::string::npos)
      sum += member_bytes(entry.path() / "stat", group);
  }
  return sum;
}

}  // namespace hapgrid
