#include "tools/stats/session.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/session/reader.hpp"
#include "tools/stats/arrays.hpp"
#include "tools/stats/log_statistics.hpp"

namespace hapgrid {

namespace {

using Json = nlohmann::ordered_json;

Json force_json(const SessionHeader& header, const LargestForce& force) {
  if (!force.any) return nullptr;
  return {{"newtons", force.newtons}, {"time_s", header.time_of(force.tick)}, {"tick", force.tick}};
}

Json times_json(const Histogram& times) {
  return {{"p50", microseconds(times.quantile(0.5))},
          {"p99", microseconds(times.quantile(0.99))},
          {"p99.9", microseconds(times.quantile(0.999))},
          {"max", microseconds(times.max())}};
}

std::string force_text(const Json& force) {
  if (force.is_null()) return "-";
  return format("{} N at {} s", rounded(force["newtons"]), to_text(force["time_s"]));
}

std::string times_text(const Json& times) {
  std::string text;
  for (const auto& time : times.items())
    text += format("{}{} {:.3f}", text.empty() ? "" : ", ", time.key(), time.value().get<double>());
  return text + " µs";
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

/// The same for people.
std::string session_text(const SessionReader& session, const Json& report) {
  const SessionHeader& header = session.header();
  const Box& box = header.box;
  const std::uint64_t ticks = report["ticks"], skipped = report["missed_or_dropped"];
  std::vector<std::pair<std::string, std::uint64_t>> flags;
  std::size_t width = std::string_view("largest force").size();
  for (const auto& flag : report["flags"].items()) {
    flags.emplace_back("flag " + printable_line(flag.key(), 40), flag.value());
    width = std::max(width, text_width(flags.back().first));
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
  line("settings",
       header.settings.empty() ? "-" : printable_line(header.settings, std::string::npos));
  line("rate", format("{} Hz", to_text(header.rate_hz)));
  line("ticks", format("{}, from {} s to {} s ({} s)", ticks, to_text(report["start_s"]),
                       to_text(report["end_s"]), rounded(report["duration_s"])));
  const std::string missed = share_text(skipped, ticks + skipped);
  line("missed", session.dropped() == 0
                     ? missed
                     : format("{} or dropped; the disk was too slow for {} of the whole session",
                              missed, session.dropped()));
  if (!session.ended_early().empty()) line("ended early", "at " + session.ended_early());
  line("largest force",
       format("{} as sent, {} before the safety core", force_text(report["largest_force"]),
              force_text(report["largest_raw_force"])));
  const Json& energy = report["energy"];
  line("energy", format("{0} {1} given to the hand, at most {2} {1} until {3} s",
                        rounded(energy["given"]), energy["unit"].get<std::string>(),
                        rounded(energy["returned"]), to_text(energy["returned_time_s"])));
  line("not computed", share_text(report["force_not_computed"], ticks));
  line("lateness", times_text(report["lateness_us"]));
  line("compute time", times_text(report["compute_us"]));
  for (const auto& [name, count] : flags) line(name, share_text(count, ticks));
  return text;
}

}  // namespace

void run_session(InputFile file, const std::string& npy, bool as_json, const std::string& output) {
  SessionReader session(std::move(file));
  SessionStatistics statistics;
  HandEnergy energy(session.header());
  for (std::vector<TickRecord> ticks; session.next(ticks);)
    for (const TickRecord& tick : ticks) {
      statistics.add(tick);
      energy.add(tick);
    }
  if (statistics.ticks == 0) throw Error(without_ticks(session));
  if (!npy.empty()) {
    write_session_array(session, statistics.ticks, npy);
    // The report has a line on it.
    if (!session.ended_early().empty())
      std::fprintf(stderr, "stats: %s: the session ended early, at %s\n",
                   printable_line(session.name()).c_str(), session.ended_early().c_str());
    return;
  }
  const Json report = session_json(session, statistics, energy);
  write_text(output, as_json ? json_text(report) : printable_text(session_text(session, report)));
}

}  // namespace hapgrid
