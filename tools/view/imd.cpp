#include "tools/view/imd.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/scene/stream.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::hours kForever{24 * 365};

bool is_regular(const std::string& name) {
  struct stat status {};
  const int failed = name == "-" ? ::fstat(STDIN_FILENO, &status) : ::stat(name.c_str(), &status);
  return failed == 0 && S_ISREG(status.st_mode);
}

/// Says which units viewers will take for other ones.
void say_units(const Scene& scene, bool has_energy, int version) {
  const ImdUnits units(version, scene.length_unit, scene.energy_unit);
  const auto print = [](const char* what, const std::string& unit, const char* taken_for) {
    say("view", format("IMD: {} go out in {}, viewers take them for {}", what,
                       unit.empty() ? "a unit without a name" : unit, taken_for));
  };
  if (!units.length_known) print("lengths", scene.length_unit, "angstrom");
  if (has_energy && !units.energy_known)
    print("energies", scene.energy_unit, ImdUnits::energy_name(version));
}

/// Says once each what of the viewers' wishes is not granted.
void say_ignored(const ImdCounts& now, const ImdCounts& before) {
  if (now.forces > 0 && before.forces == 0)
    say("view",
        "IMD: a viewer sends forces; they are ignored, since the hand alone moves the model");
  if (now.rates > 0 && before.rates == 0)
    say("view", "IMD: a viewer asks for another rate (TRATE); it gets each frame that play makes");
  if (now.refused > 0 && before.refused == 0)
    say("view", format("IMD: one more viewer came and was sent away: {} can watch",
                       ImdServer::kMaxClients));
}

/// Seconds from one tick to the next, as two frames tell.
double tick_of(const std::vector<Frame>& frames) {
  if (frames.size() < 2 || frames[1].tick <= frames[0].tick) return 1e-3;
  return (frames[1].time_s - frames[0].time_s) /
         static_cast<double>(frames[1].tick - frames[0].tick);
}

}  // namespace

std::optional<ImdOptions> read_imd(const std::string& text) {
  ImdOptions options;
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == text.npos ? text : text.substr(colon + 1);
  if (colon != text.npos) {
    options.address = text.substr(0, colon);
    const bool six = options.address.starts_with('[') && options.address.ends_with(']');
    if (six) options.address = options.address.substr(1, options.address.size() - 2);
    if (six != (options.address.find(':') != text.npos)) return std::nullopt;
    if (!ImdServer::is_address(options.address)) return std::nullopt;
  }
  const char* const end = port.data() + port.size();
  const auto read = std::from_chars(port.data(), end, options.port);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return options;
}

void run_imd(const std::string& name, const ImdOptions& options) {
  ImdServer server(options);
  say("view", format("IMD version {} on {}", options.version, server.name()));
  SceneReader reader(name);
  std::vector<Frame> first;  // two of them tell the length of a tick
  for (Frame frame; first.size() < 2 && reader.next(frame);) first.push_back(frame);
  if (first.empty()) throw Error(format("{}: no frame in it, nothing to show", reader.name()));
  const bool has_energy = !std::isnan(first[0].energy);
  say_units(reader.scene(), has_energy, options.version);
  const bool recorded = is_regular(name);
  server.start(reader.scene(), has_energy, tick_of(first), /*paced=*/!recorded);
  const std::atomic<int> never{0};
  if (recorded) server.wait_for_viewer(kForever, never);
  const auto start = Clock::now();
  const double start_s = first[0].time_s;
  ImdCounts before;
  const auto show = [&](const Frame& frame) {
    if (recorded)
      std::this_thread::sleep_until(
          start + std::chrono::duration_cast<Clock::duration>(
                      std::chrono::duration<double>(std::min(frame.time_s - start_s, 1e8))));
    server.publish(frame);
    const ImdCounts now = server.counts();
    say_ignored(now, before);
    before = now;
  };
  for (const Frame& frame : first) show(frame);
  for (Frame frame; reader.next(frame);) show(frame);
  const ImdCounts counts = server.finish();
  say_ignored(counts, before);
  say("view",
      format("IMD viewers {}, frames sent {}, dropped {}; closed because they did not read {}",
             counts.viewers, counts.sent, counts.dropped, counts.slow));
}

}  // namespace hapgrid
