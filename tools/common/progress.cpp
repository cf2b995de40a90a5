#include "tools/common/progress.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>

#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/signals.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

using Clock = std::chrono::steady_clock;

const Clock::time_point kProcessStart = Clock::now();

constexpr std::chrono::milliseconds kOften{250};     // a line that is written over
constexpr std::chrono::milliseconds kSeldom{60000};  // a line in a log

/// One less than the terminal has, so that no line is wrapped; all where its size is unknown.
std::size_t columns_of(std::FILE* terminal) {
  winsize size{};
  if (::ioctl(::fileno(terminal), TIOCGWINSZ, &size) != 0 || size.ws_col < 2)
    return std::string::npos;
  return size.ws_col - 1u;
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Of this process, and of the model processes that it has ended.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  rusage models{};
  ::getrusage(RUSAGE_CHILDREN, &models);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) +
         seconds(models.ru_utime) + seconds(models.ru_stime);
}

}  // namespace

ProgressLine::ProgressLine(std::function<std::string(double)> text) : text_(std::move(text)) {
  const BlockedSignals blocked;  // they are the caller's, whose waiting they end
  thread_ = std::jthread([this] { show(); });
}

ProgressLine::~ProgressLine() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void ProgressLine::show() {
  const Clock::time_point start = Clock::now();
  std::unique_lock lock(mutex_);
  write_progress(
      stderr, [&] { return text_(seconds_since(start)); },
      [&](std::chrono::milliseconds pause) {
        return wake_.wait_for(lock, pause, [this] { return done_; });
      });
}

void write_progress(std::FILE* out, const std::function<std::string()>& text,
                    const std::function<bool(std::chrono::milliseconds)>& over) {
  const bool terminal = ::isatty(::fileno(out)) == 1;
  bool shown = false;
  while (!over(terminal ? kOften : kSeldom)) {
    if (terminal)
      std::fprintf(out, "\r\033[K%s", text().substr(0, columns_of(out)).c_str());
    else
      std::fprintf(out, "%s\n", text().c_str());
    std::fflush(out);
    shown = terminal;
  }
  if (shown) std::fputs("\r\033[K", out);
}

std::string part_done(double part, double rate) {
  // What is not over is not 100 %.
  std::string done = format("{:.0f} %", std::floor(100 * std::clamp(part, 0.0, 0.99)));
  if (!(rate > 0) || !(part > 0)) return done;
  const double seconds = std::max((1 - part) / rate, 1.0);
  if (seconds < 90) return format("{}, {:.0f} s left", done, seconds);
  if (seconds < 5400) return format("{}, {:.0f} min left", done, seconds / 60);
  return format("{}, {:.1f} h left", done, seconds / 3600);
}

std::string short_number(double value) {
  static constexpr std::array<const char*, 5> kUnits = {"", " k", " M", " G", " T"};
  std::size_t unit = 0;
  for (; value >= 999.5 && unit + 1 < kUnits.size(); ++unit) value /= 1000;
  return unit == 0 ? format("{:.0f}", value) : format("{:.3g}{}", value, kUnits[unit]);
}

void append_cost(const std::string& file, const RunCost& cost) {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  nlohmann::ordered_json line = {{"tool", cost.tool},
                                 {"generation", cost.generation},
                                 {"part", cost.part},
                                 {"parts", cost.parts},
                                 {"conversions", cost.conversions},
                                 {"wall_seconds", seconds_since(kProcessStart)},
                                 {"cpu_seconds", cpu_seconds()},
                                 {"host", host.data()}};
  if (!cost.failed.empty()) line["failed"] = cost.failed;
  const FileDescriptor out(::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  // Lines of processes that share the file stay whole, also when the disk takes half of one.
  if (out && ::flock(out.get(), LOCK_EX) != 0)
    say(cost.tool, format("{} cannot be locked ({}): let one process at a time write there", file,
                          std::generic_category().message(errno)));
  struct stat before {};
  if (!out || ::fstat(out.get(), &before) != 0)
    throw std::system_error(errno, std::generic_category(), file);
  const std::string text = json_line(line) + "\n";
  try {
    write_all(out.get(), std::as_bytes(std::span(text)), file);
  } catch (...) {
    static_cast<void>(!::ftruncate(out.get(), before.st_size));
    throw;
  }
}

void allow_open_files(std::size_t files) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  const rlim_t wanted = std::min<rlim_t>(files + 64, limit.rlim_max);
  if (limit.rlim_cur >= wanted) return;
  limit.rlim_cur = wanted;
  ::setrlimit(RLIMIT_NOFILE, &limit);  // where it is refused, opening says what is wrong
}

}  // namespace hapgrid
