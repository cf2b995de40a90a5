// The options of play.
#pragma once

#include <optional>
#include <string>

#include "libcore/loop/realtime.hpp"
#include "tools/common/models.hpp"
#include "tools/common/traversals.hpp"
#include "tools/play/devices.hpp"
#include "tools/play/settings.hpp"

namespace hapgrid {

struct PlayOptions {
  std::string grid;
  std::optional<DeviceChoice> device;
  std::string device_text;  ///< its name, as it was given
  double rate_hz = 0;       ///< 0: kDefaultRateHz for a live device, no pace for a scripted one
  std::optional<TraversalRule> traversal;
  std::optional<std::string> beside;     ///< is_beside()
  double duration_s = 0;                 ///< 0: until the device ends
  std::optional<RealtimeMode> realtime;  ///< nothing: kTry
  std::string log;
  std::string frames;
  std::string report;
  ModelOptions model;
  GivenSettings given;
  PlayFile file;  ///< of --config
  // Instead of playing.
  bool selftest = false;
  bool list_devices = false;
};

/// The rate of a live device for which none was given.
inline constexpr double kDefaultRateHz = 1000;

/// Binds them.
void add_play_options(CommandLine& app, PlayOptions& options);

/// To be called before anything is opened.
/// @throw UsageError, Error for a command line that cannot be played: what is missing, excludes
/// each other, or would replace an input.
void require_possible(const PlayOptions& options);

}  // namespace hapgrid
