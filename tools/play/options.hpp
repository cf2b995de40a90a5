// The options of play, on the command line and in the table [play] of a MODEL.toml.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libcore/device/pid.hpp"
#include "libcore/haptic/loop.hpp"
#include "libcore/haptic/realtime.hpp"
#include "libcore/scene/imd_server.hpp"

namespace CLI {
class App;
}

namespace hapgrid {

struct PlayOptions {
  std::string grid;
  std::string device;
  double rate_hz =
      0;  // 0: the device's own: kDefaultRateHz for a live one, no pace for a scripted one
  double spin_us = 0;
  double duration_s = 0;  // 0: until the device ends
  RealtimeMode realtime = RealtimeMode::kTry;
  std::string log;
  std::string frames;
  std::string report;
  std::optional<std::uint16_t> imd_port;
  ImdOptions imd;
  double imd_wait_s = 0;
  std::vector<std::string> model_path;
  SafetyLimits safety;
  MappingOptions mapping;
  double key_step = 0;            // model's units; 0: half of the grid's spacing
  std::vector<double> key_start;  // empty: the middle of the box
  PidParameters pid;
  std::uint16_t max_sub_steps = Traversal::kDefaultMaxSubSteps;
  // Instead of playing.
  bool selftest = false;
  double selftest_s = 4;
  bool list_devices = false;
  std::string dump_descriptor;

  bool plays() const { return !selftest && !list_devices && dump_descriptor.empty(); }
};

/// What a live device is driven at.
inline constexpr double kDefaultRateHz = 1000;

/// The limits of a replay: those of the session, but for what the command line says.
SafetyLimits replay_limits(const CLI::App& app, const PlayOptions& options, SafetyLimits recorded);

/// Binds them; --config FILE takes them from a table [play].
void add_play_options(CLI::App& app, PlayOptions& options);

}  // namespace hapgrid
