#include "tools/play/report.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/file.hpp"

namespace hapgrid {

namespace {

using Json = nlohmann::ordered_json;

double microseconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-3; }

Json to_json(const Histogram& h) {
  Json bins = Json::array();
  for (const Histogram::Bin& bin : h.bins())
    bins.push_back({microseconds(bin.from), microseconds(bin.to), bin.count});
  return {{"p50_us", microseconds(h.quantile(0.5))},
          {"p99_us", microseconds(h.quantile(0.99))},
          {"p99.9_us", microseconds(h.quantile(0.999))},
          {"max_us", microseconds(h.max())},
          {"histogram", {{"columns", {"from_us", "to_us", "ticks"}}, {"bins", bins}}}};
}

const char* name_of(LoopEnd end) {
  switch (end) {
    case LoopEnd::kDeviceEnd:
      return "device";
    case LoopEnd::kStopped:
      return "signal";
    case LoopEnd::kTicks:
      return "duration";
    case LoopEnd::kDeviceFailed:
      return "device failed";
  }
  return "";
}

}  // namespace

std::string three_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string quantiles_text(const Histogram& h) {
  return "p50 " + three_digits(microseconds(h.quantile(0.5))) + ", p99 " +
         three_digits(microseconds(h.quantile(0.99))) + ", p99.9 " +
         three_digits(microseconds(h.quantile(0.999))) + ", max " +
         three_digits(microseconds(h.max())) + " µs";
}

void print_summary(const LoopSummary& s, const RunFacts& facts) {
  const auto n = [](std::uint64_t count) { return static_cast<unsigned long long>(count); };
  std::fprintf(
      stderr,
      "play: %llu ticks, %llu cell switches: %llu face, %llu edge, %llu vertex; %s in %llu "
      "ticks\n",
      n(s.ticks), n(s.face_switches + s.edge_switches + s.vertex_switches), n(s.face_switches),
      n(s.edge_switches), n(s.vertex_switches),
      facts.traversal == "branch" ? "the state snapped" : "levels changed", n(s.level_changed));
  std::fprintf(stderr,
               "play: ticks outside the box %llu, with a jump split %llu, lagging behind a jump "
               "%llu\n",
               n(s.outside), n(s.split), n(s.lagging));
  std::string acted;
  for (std::size_t i = 0; i < kSafetyActions; ++i)
    if (s.acted[i] > 0)
      acted += (acted.empty() ? "" : ", ") + std::string(kSafetyNames[i]) + " " +
               std::to_string(s.acted[i]);
  std::fprintf(stderr, "play: largest force %s N of the model, %s N sent; safety, in ticks: %s\n",
               three_digits(s.largest_raw).c_str(), three_digits(s.largest_force).c_str(),
               acted.empty() ? "nothing to do" : acted.c_str());
  if (facts.sessions) std::fputs(sessions_text(*facts.sessions).c_str(), stderr);
  if (facts.rate_hz > 0) {
    std::fprintf(stderr, "play: ticks missed at %g Hz: %llu, in %llu overruns\n", facts.rate_hz,
                 n(s.missed), n(s.overruns));
    std::fprintf(stderr, "play: lateness %s; computing %s\n", quantiles_text(s.lateness).c_str(),
                 quantiles_text(s.compute).c_str());
  }
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
  if (facts.sessions) report["simulation"] = sessions_json(*facts.sessions);
  OutputFile output(file, /*binary=*/false);
  output.write(report.dump(2, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace) + "\n");
  output.commit();
}

}  // namespace hapgrid
