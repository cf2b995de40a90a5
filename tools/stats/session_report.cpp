#include "tools/stats/session_report.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::initializer_list<std::pair<const char*, double>> kPercentiles{
    {"p50", 0.5}, {"p99", 0.99}, {"p99.9", 0.999}};

Json force_json(const SessionHeader& header, const LargestForce& force) {
  if (!force.any) return nullptr;
  return {{"newtons", force.newtons}, {"time_s", header.time_of(force.tick)}, {"tick", force.tick}};
}

double microseconds(std::int64_t ns) { return static_cast<double>(ns) / 1e3; }

Json times_json(const Histogram& times) {
  Json json;
  for (const auto& [name, share] : kPercentiles) json[name] = microseconds(times.quantile(share));
  json["max"] = microseconds(times.max());
  return json;
}

std::string force_text(const SessionHeader& header, const LargestForce& force) {
  if (!force.any) return "-";
  return rounded(force.newtons) + " N at " + to_text(header.time_of(force.tick)) + " s";
}

std::string times_text(const Histogram& times) {
  std::string text;
  for (const auto& [name, share] : kPercentiles)
    text += std::string(name) + " " + fixed(microseconds(times.quantile(share)), 3) + ", ";
  return text + "max " + fixed(microseconds(times.max()), 3) + " µs";
}

std::string share_text(std::uint64_t part, std::uint64_t whole) {
  return std::to_string(part) + " (" +
         fixed(100 * static_cast<double>(part) / static_cast<double>(whole), 3) + " %)";
}

}  // namespace

EnergyUnit energy_unit(const SessionHeader& header) {
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
  const EnergyUnit unit = energy_unit(session.header());
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
       {{"unit", unit.name},
        {"given", energy.given() * unit.factor},
        {"returned", energy.returned() * unit.factor},
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
    width = std::max(width, flags.back().size());
  }
  std::string text;
  const auto line = [&](std::string name, const std::string& value) {
    name.resize(width + 1, ' ');
    text += name + value + "\n";
  };
  line("model", printable_line(header.model));
  line("grid", header.grid_digest.empty() ? "-" : printable_line(header.grid_digest));
  const auto count = [&](int axis) { return std::to_string(box.counts[axis]); };
  line("box", count(0) + " x " + count(1) + " x " + count(2) + " points, " + to_text(box.spacing) +
                  " apart, from " + state_text(box.origin) +
                  (header.length_unit.empty() ? "" : " " + printable_line(header.length_unit)));
  line("settings", header.settings.empty() ? "-" : printable_line(header.settings));
  line("rate", to_text(header.rate_hz) + " Hz");
  line("ticks", std::to_string(s.ticks) + ", from " + to_text(start) + " s to " + to_text(end) +
                    " s (" + rounded(end - start) + " s)");
  if (session.dropped() == 0)
    line("missed", share_text(s.skipped, s.ticks + s.skipped));
  else
    line("missed", share_text(s.skipped, s.ticks + s.skipped) +
                       " or dropped; the disk was too "
                       "slow for " +
                       std::to_string(session.dropped()) + " of the whole session");
  if (!session.ended_early().empty()) line("ended early", "at " + session.ended_early());
  line("largest force", force_text(header, s.sent) + " as sent, " + force_text(header, s.raw) +
                            " before the safety core");
  const EnergyUnit unit = energy_unit(header);
  line("energy", rounded(energy.given() * unit.factor) + " " + unit.name +
                     " given to the hand, at most " + rounded(energy.returned() * unit.factor) +
                     " " + unit.name + " until " + to_text(header.time_of(energy.returned_tick())) +
                     " s");
  line("not computed", share_text(s.not_computed, s.ticks));
  line("lateness", times_text(s.lateness));
  line("compute time", times_text(s.compute));
  for (std::size_t i = 0; i < header.flags.size(); ++i)
    line(flags[i], share_text(s.flags[i], s.ticks));
  return text;
}

}  // namespace hapgrid
