#include "tools/stats/session.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/json_text.hpp"
#include "libcore/base/table.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/session/reader.hpp"
#include "libcore/session/statistics.hpp"
#include "libcore/session/text.hpp"
#include "tools/stats/arrays.hpp"

namespace hapgrid {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::initializer_list<std::pair<const char*, double>> kPercentiles{
    {"p50", 0.5}, {"p99", 0.99}, {"p99.9", 0.999}};

Json force_json(const SessionHeader& header, const LargestForce& force) {
  if (!force.any) return nullptr;
  return {{"newtons", force.newtons}, {"time_s", header.time_of(force.tick)}, {"tick", force.tick}};
}

Json times_json(const Histogram& times) {
  Json json;
  for (const auto& [name, share] : kPercentiles) json[name] = microseconds(times.quantile(share));
  json["max"] = microseconds(times.max());
  return json;
}

std::string force_text(const SessionHeader& header, const LargestForce& force) {
  if (!force.any) return "-";
  return format("{} N at {} s", rounded(force.newtons), to_text(header.time_of(force.tick)));
}

std::string times_text(const Histogram& times) {
  std::string text;
  for (const auto& [name, share] : kPercentiles)
    text += format("{} {:.3f}, ", name, microseconds(times.quantile(share)));
  return format("{}max {:.3f} µs", text, microseconds(times.max()));
}

std::string share_text(std::uint64_t part, std::uint64_t whole) {
  return format("{} ({:.3f} %)", part,
                100 * static_cast<double>(part) / static_cast<double>(whole));
}

/// The factor from newtons times the box's unit of length to the unit in which energies are shown,
/// and its name: mJ if the settings tell how many units of length a metre of the hand is.
std::pair<double, std::string> energy_unit(const SessionHeader& header) {
  const Json settings = nests_too_deep(header.settings)
                            ? Json()
                            : Json::parse(header.settings, nullptr, /*allow_exceptions=*/false);
  if (settings.is_object() && settings.contains("scale_per_m") &&
      settings["scale_per_m"].is_number()) {
    const double scale = settings["scale_per_m"].get<double>();
    if (scale > 0 && std::isfinite(1000 / scale)) return {1000 / scale, "mJ"};
  }
  return {1, "N " + (header.length_unit.empty() ? "model's unit of length"
                                                : unit_sign(header.length_unit))};
}

Json session_json(const SessionReader& session, const SessionStatistics& s,
                  const HandEnergy& energy) {
  const auto unit = energy_unit(session.header());
  const SessionHeader& header = session.header();
  Json flags = Json::object();
  for (std::size_t i = 0; i < header.flags.size(); ++i) flags[header.flags[i]] = s.flags[i];
  const double start = header.time_of(s.first);
  const double end = header.time_of(s.last);
  return {
      {"version", 1},
      {"model", header.model},
      {"grid_digest", header.grid_digest},
      {"box",
       {{"origin", header.box.origin},
        {"spacing", header.box.spacing},
        {"counts", header.box.counts}}},
      {"length_unit", header.length_unit},
      {"settings", header.settings},
      {"rate_hz", header.rate_hz},
      {"ticks", s.ticks},
      {"start_s", start},
      {"end_s", end},
      {"duration_s", end - start},
      {"missed", session.dropped() == 0 ? Json(s.skipped) : Json(nullptr)},
      {"missed_or_dropped", s.skipped},
      {"dropped", session.dropped()},
      {"ended_early", session.ended_early().empty() ? Json(nullptr) : Json(session.ended_early())},
      {"largest_raw_force", force_json(header, s.raw)},
      {"largest_force", force_json(header, s.sent)},
      {"energy",
       {{"unit", unit.second},
        {"given", energy.given() * unit.first},
        {"returned", energy.returned() * unit.first},
        {"returned_time_s", header.time_of(energy.returned_tick())}}},
      {"force_not_computed", s.not_computed},
      {"flags", flags},
      {"lateness_us", times_json(s.lateness)},
      {"compute_us", times_json(s.compute)}};
}

std::string session_text(const SessionReader& session, const SessionStatistics& s,
                         const HandEnergy& energy) {
  const SessionHeader& header = session.header();
  const Box& box = header.box;
  const double start = header.time_of(s.first);
  const double end = header.time_of(s.last);
  std::vector<std::string> flags;
  std::size_t width = std::string_view("largest force").size();
  for (const std::string& name : header.flags) {
    flags.push_back("flag " + printable_line(name, 40));
    width = std::max(width, text_width(flags.back()));
  }
  std::string text;
  const auto line = [&](const std::string& name, const std::string& value) {
    text += format("{}{}\n", left(name, width + 1), value);
  };
  line("model", printable_line(header.model));
  line("grid", header.grid_digest.empty() ? "-" : printable_line(header.grid_digest));
  const auto& n = box.counts;
  line("box", format("{} x {} x {} points, {} apart, from {}{}", n[0], n[1], n[2],
                     to_text(box.spacing), state_text(box.origin),
                     header.length_unit.empty() ? "" : " " + printable_line(header.length_unit)));
  line("settings", header.settings.empty() ? "-" : printable_line(header.settings));
  line("rate", format("{} Hz", to_text(header.rate_hz)));
  line("ticks", format("{}, from {} s to {} s ({} s)", s.ticks, to_text(start), to_text(end),
                       rounded(end - start)));
  const std::string missed = share_text(s.skipped, s.ticks + s.skipped);
  line("missed", session.dropped() == 0
                     ? missed
                     : format("{} or dropped; the disk was too slow for {} of the whole session",
                              missed, session.dropped()));
  if (!session.ended_early().empty()) line("ended early", "at " + session.ended_early());
  line("largest force", format("{} as sent, {} before the safety core", force_text(header, s.sent),
                               force_text(header, s.raw)));
  const auto unit = energy_unit(header);
  line("energy", format("{0} {1} given to the hand, at most {2} {1} until {3} s",
                        rounded(energy.given() * unit.first), unit.second,
                        rounded(energy.returned() * unit.first),
                        to_text(header.time_of(energy.returned_tick()))));
  line("not computed", share_text(s.not_computed, s.ticks));
  line("lateness", times_text(s.lateness));
  line("compute time", times_text(s.compute));
  for (std::size_t i = 0; i < header.flags.size(); ++i)
    line(flags[i], share_text(s.flags[i], s.ticks));
  return text;
}

/// Calls `use` on all ticks, from the first on.
template <class F>
void for_ticks(SessionReader& session, F&& use) {
  session.rewind();
  for (std::vector<TickRecord> ticks; session.next(ticks);)
    for (const TickRecord& tick : ticks) use(tick);
}

}  // namespace

void run_session(InputFile file, const SessionOptions& options) {
  constexpr std::size_t kBuffer = 1 << 18;
  SessionReader session(std::move(file));
  const SessionHeader& header = session.header();
  std::optional<OutputFile> exported;
  if (!options.export_file.empty()) exported.emplace(options.export_file, /*binary=*/false);
  std::string text = session_text_header();
  SessionStatistics statistics;
  HandEnergy energy(header);
  for_ticks(session, [&](const TickRecord& tick) {
    statistics.add(tick);
    energy.add(tick);
    if (!exported) return;
    append_session_text(text, header, tick);
    if (text.size() < kBuffer) return;
    exported->write(text);
    text.clear();
  });
  if (statistics.ticks == 0) throw Error(without_ticks(session));
  if (exported) {
    exported->write(text);
    exported->commit();
  }
  if (!options.npy.empty())
    write_session_array(
        header, statistics.ticks, [&](const auto& use) { for_ticks(session, use); }, options.npy);
  if (exported || !options.npy.empty()) {
    // The report has a line on it.
    if (!session.ended_early().empty())
      std::fprintf(stderr, "stats: %s: the session ended early, at %s\n",
                   printable_line(session.name()).c_str(), session.ended_early().c_str());
    return;
  }

  OutputFile output(options.output, /*binary=*/false);
  if (options.format == "text")
    output.write(printable_text(session_text(session, statistics, energy)));
  else
    output.write(json_text(session_json(session, statistics, energy)));
  output.commit();
}

}  // namespace hapgrid
