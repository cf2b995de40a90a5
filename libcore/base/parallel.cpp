#include "libcore/base/parallel.hpp"

#include <sched.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

namespace hapgrid {

namespace fs = std::filesystem;

namespace {

double number_in(const fs::path& file) {
  double number = 0;
  std::ifstream(file) >> number;
  return number;
}

/// How many processors a control group may use, of version 2 or 1; infinite where there is no
/// quota, which is "max" or -1.
double quota_of(const fs::path& group) {
  double quota = 0, period = 0;
  if (!(std::ifstream(group / "cpu.max") >> quota >> period)) {
    quota = number_in(group / "cpu.cfs_quota_us");
    period = number_in(group / "cpu.cfs_period_us");
  }
  return quota > 0 && period > 0 ? quota / period : std::numeric_limits<double>::infinity();
}

}  // namespace

int all_threads(const std::string& root) {
  cpu_set_t allowed;
  double processors = ::sched_getaffinity(0, sizeof allowed, &allowed) == 0
                          ? CPU_COUNT(&allowed)
                          : std::thread::hardware_concurrency();
  std::ifstream groups(root + "proc/self/cgroup");
  for (std::string number, controllers, path; std::getline(groups, number, ':') &&
                                              std::getline(groups, controllers, ':') &&
                                              std::getline(groups, path);) {
    const bool limits_time = ("," + controllers + ",").find(",cpu,") != std::string::npos;
    if (!controllers.empty() && !limits_time) continue;
    const fs::path top = root + "sys/fs/cgroup/" + controllers;
    // A container sees its own group as the top one, whatever the path says.
    for (fs::path group = fs::path(path).relative_path();; group = group.parent_path()) {
      processors = std::min(processors, quota_of(top / group));
      if (group.empty()) break;
    }
  }
  return static_cast<int>(std::max(1.0, std::ceil(processors)));
}

}  // namespace hapgrid
