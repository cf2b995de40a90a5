#include "tools/play/session_log.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "tools/play/beside.hpp"

namespace hapgrid {

namespace {

using Json = nlohmann::ordered_json;

// The flags of a tick: first the bits of the safety core, then these.
enum : std::uint32_t {
  kClutchBit = kSafetyActions,
  kStalledBit,
  kResetBit,
  kNextBit,
  kLevelBit,
  kBeginsBit
};

/// Calls f(name, value) for each limit.
template <class Limits, class F>
void each_limit(Limits& limits, F&& f) {
  f("gain", limits.gain);
  f("max_force_N", limits.max_force);
  f("slew_N_per_ms", limits.slew);
  f("ramp_ms", limits.ramp_ms);
  f("max_speed_m_per_s", limits.max_speed);
  f("buzz_force_N", limits.buzz_force);
  f("buzz_rate_per_s", limits.buzz_rate);
  f("fade_cells", limits.fade_cells);
  f("watchdog_ticks", limits.watchdog_ticks);
  f("reserve_mJ", limits.reserve);
  f("acceleration_m_per_s2", limits.acceleration);
  f("encoder_m", limits.encoder);
  f("delay_ticks", limits.delay_ticks);
}

}  // namespace

bool is_session_name(const std::string& file) { return file.ends_with(".session"); }

SessionHeader session_header(const GridSpec& spec, const std::string& digest, double rate_hz,
                             const PlayedWith& with) {
  SessionHeader header;
  header.model = spec.model;
  header.grid_digest = digest;
  header.length_unit = spec.length_unit;
  header.box = spec.box;
  header.rate_hz = rate_hz;
  for (const char* name : kSafetyNames) header.flags.push_back(kSafetyFlag + std::string(name));
  header.flags.insert(header.flags.end(),
                      {kClutchFlag, kStalledFlag, kResetFlag, kNextFlag, kLevelFlag, kBeginsFlag});
  Json safety;
  // JSON has no infinity; null stands for it.
  each_limit(with.limits, [&](const char* name, double value) { safety[name] = value; });
  header.settings = json_line({{"safety", safety},
                               {"scale_per_m", with.scale},
                               {"traversal", name_of(with.traversal)},
                               {"beside", with.beside}});
  return header;
}

PlayedWith played_with(const SessionHeader& header, const std::string& name) {
  PlayedWith with;
  try {
    if (nests_too_deep(header.settings))
      throw Error(format("{}: its settings are not those of play", name));
    const Json settings = Json::parse(header.settings);
    each_limit(with.limits, [&](const char* key, double& value) {
      const Json& written = settings.at("safety").at(key);
      value = written.is_null() ? std::numeric_limits<double>::infinity() : written.get<double>();
    });
    with.scale = settings.at("scale_per_m").get<double>();
    const auto rule = rule_named(settings.at("traversal").get<std::string>());
    if (!rule)
      throw Error(format("{}: played by a rule of traversal that this program lacks", name));
    with.traversal = *rule;
    with.beside = settings.at("beside").get<std::string>();
    if (!is_beside(with.beside))
      throw Error(format("{}: played with an answer to --beside that this program lacks", name));
  } catch (const Json::exception&) {
    throw Error(format("{}: its settings are not those of play", name));
  }
  return with;
}

TickRecord tick_record(const Tick& tick) noexcept {
  const auto bit = [](bool set, std::uint32_t number) { return std::uint32_t{set} << number; };
  return {.number = tick.number,
          .hip = tick.hip,
          .raw_force = tick.raw_force,
          .force = tick.force.force,
          .levels = tick.traversal.levels(),
          .flags = tick.force.acted | bit(tick.input.clutch, kClutchBit) |
                   bit(tick.input.stalled, kStalledBit) | bit(tick.input.reset, kResetBit) |
                   bit(tick.input.next, kNextBit) | bit(tick.step.level_changed, kLevelBit) |
                   bit(tick.input.begins, kBeginsBit),
          .lateness_ns = saturated_ns(tick.lateness_ns),
          .compute_ns = saturated_ns(tick.compute_ns),
          .slew_ns = tick.force.acted & (kSlewed | kEnergy) ? saturated_ns(tick.slew_ns) : 0};
}

}  // namespace hapgrid
