#include "tools/play/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Histogram& h) {
  Json bins = Json::array();
  h.for_each_bin([&](std::int64_t from, std::int64_t to, std::uint64_t count) {
    bins.push_back({microseconds(from), microseconds(to), count});
  });
  return {{"p50_us", microseconds(h.quantile(0.5))},
          {"p99_us", microseconds(h.quantile(0.99))},
          {"p99.9_us", microseconds(h.quantile(0.999))},
          {"max_us", microseconds(h.max())},
          {"histogram", {{"columns", {"from_us", "to_us", "ticks"}}, {"bins", bins}}}};
}

const char* name_of(LoopExit end) {
  switch (end) {
    case LoopExit::kDeviceEnd:
      return "device";
    case LoopExit::kStopped:
      return "signal";
    case LoopExit::kTicks:
      return "duration";
    case LoopExit::kDeviceFailed:
      return "device failed";
  }
  return "";
}

Json to_json(const Beside& beside) {
  return {{"asked", beside.has_thread() ? "by a thread" : "in the tick"},
          {"ticks", beside.tick()},
          {"kept_up", beside.kept_up()},
          {"late_ticks",
           {{"median", beside.lateness().quantile(0.5)}, {"most", beside.lateness().max()}}}};
}

/// How often a model kept up that is asked by a thread.
std::string beside_text(const Beside& beside) {
  if (beside.tick() == 0) return "";
  const double kept_up =
      100.0 * static_cast<double>(beside.kept_up()) / static_cast<double>(beside.tick());
  return format(
      "play: the model beside the grid kept up in {:.4g} % of the ticks; its answers were late by "
      "{} ticks (median), {} at most\n",
      kept_up, beside.lateness().quantile(0.5), beside.lateness().max());
}

}  // namespace

std::string quantiles_text(const Histogram& h) {
  return format("p50 {:.3g}, p99 {:.3g}, p99.9 {:.3g}, max {:.3g} µs",
                microseconds(h.quantile(0.5)), microseconds(h.quantile(0.99)),
                microseconds(h.quantile(0.999)), microseconds(h.max()));
}

// One answer in ten is a habit; fewer are a machine that stands still for a moment.
constexpr double kLateShare = 0.9;
constexpr std::uint64_t kEnoughAnswers = 200;

double answer_delay_ticks(const RunFacts& facts) {
  if (!facts.answers || facts.rate_hz <= 0 || facts.answers->count() < kEnoughAnswers) return 0;
  const double periods =
      1e-9 * static_cast<double>(facts.answers->quantile(kLateShare)) * facts.rate_hz;
  return std::max(0.0, std::ceil(periods) - 1);
}

std::string counted(std::uint64_t number, const char* what) {
  const std::string_view one = what;
  return format("{} {}{}", number, one, number == 1 ? "" : one.ends_with("ch") ? "es" : "s");
}

void print_summary(const LoopSummary& s, const RunFacts& facts) {
  std::string text = format(
      "play: {}, {}: {} face, {} edge, {} vertex; {} in {}\n"
      "play: ticks outside the box {}, with a jump split {}, lagging behind a jump {}\n",
      counted(s.ticks, "tick"),
      counted(s.face_switches + s.edge_switches + s.vertex_switches, "cell switch"),
      s.face_switches, s.edge_switches, s.vertex_switches,
      facts.traversal == "branch" ? "the state snapped" : "levels changed",
      counted(s.level_changed, "tick"), s.outside, s.split, s.lagging);
  if (s.outside == s.ticks && s.ticks > 0)
    text += "play: the whole way was outside of the grid's box: nothing was felt\n";
  std::string acted;
  for (std::size_t i = 0; i < kSafetyActions; ++i)
    if (s.acted[i] > 0)
      acted += format("{}{} {}", acted.empty() ? "" : ", ", kSafetyNames[i], s.acted[i]);
  text += format("play: largest force {:.3g} N of the model, {:.3g} N sent; safety, in ticks: {}\n",
                 s.largest_raw, s.largest_force, acted.empty() ? "nothing to do" : acted);
  if (facts.beside && facts.beside->has_thread()) text += beside_text(*facts.beside);
  if (const double ticks = answer_delay_ticks(facts); ticks > facts.declared_delay)
    text += format(
        "play: of 10 answers of the adapter, one came {:.3g} ms after its force or later: the "
        "force acts late, set safety.delay = {:g} in the file of --config\n",
        1e-6 * static_cast<double>(facts.answers->quantile(kLateShare)), ticks);
  if (facts.rate_hz > 0)
    text += format("play: ticks missed at {:g} Hz: {}, in {}\nplay: lateness {}; computing {}\n",
                   facts.rate_hz, s.missed, counted(s.overruns, "overrun"),
                   quantiles_text(s.lateness), quantiles_text(s.compute));
  std::fputs(text.c_str(), stderr);
}

void write_report(const std::string& file, const LoopSummary& s, const RunFacts& facts) {
  Json safety;
  for (std::size_t i = 0; i < kSafetyActions; ++i) safety[kSafetyNames[i]] = s.acted[i];
  Json report{
      {"version", 1},
      {"model", facts.model},
      {"device", facts.device},
      {"traversal", facts.traversal},
      {"force", facts.force},
      {"beside", facts.beside ? to_json(*facts.beside) : Json()},
      {"rate_hz", facts.rate_hz},
      {"realtime", facts.realtime},
      {"end", name_of(s.end)},
      {"exit_code", facts.exit_code},
      {"zero_sent", s.zero_sent},
      {"ticks", s.ticks},
      {"missed", s.missed},
      {"overruns", s.overruns},
      {"switches",
       {{"face", s.face_switches}, {"edge", s.edge_switches}, {"vertex", s.vertex_switches}}},
      {"level_changed", s.level_changed},
      {"outside", s.outside},
      {"split", s.split},
      {"lagging", s.lagging},
      {"largest_force_of_model_N", s.largest_raw},
      {"largest_force_sent_N", s.largest_force},
      {"safety_ticks", safety},
      {"lateness", to_json(s.lateness)},
      {"compute", to_json(s.compute)}};
  if (facts.frames)
    report["frames"] = {{"written", facts.frames->written}, {"dropped", facts.frames->dropped}};
  if (facts.answers)
    report["answers"] = {{"p90_us", microseconds(facts.answers->quantile(kLateShare))},
                         {"delay_ticks", answer_delay_ticks(facts)},
                         {"declared_ticks", facts.declared_delay}};
  write_text(file, json_text(report));
}

}  // namespace hapgrid
