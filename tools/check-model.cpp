// check-model: finds what would go wrong in the search of a grid before the search is paid for.

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"
#include "libcore/search/converter.hpp"
#include "libcore/search/seed.hpp"
#include "tools/check-model/estimate.hpp"
#include "tools/check-model/model_check.hpp"
#include "tools/common/crash.hpp"
#include "tools/common/definition.hpp"
#include "tools/common/models.hpp"
#include "tools/common/tool.hpp"

using namespace hapgrid;

namespace {

using Json = nlohmann::ordered_json;

// Force and shape together may take this part of the 200 microseconds of a tick at 5 kHz.
constexpr double kLoopBudget = 100e-6;

constexpr double kEstimateShare = 0.25;    // of the time
constexpr std::uint64_t kFewestCalls = 5;  // of C, that tell how long one takes

struct Options {
  DefinitionOptions definition;
  DefinedModelOptions model;
  std::uint64_t steps = 2000;
  double seconds = 20;
  std::string format = "text";
  std::string output = "-";
};

/// With a unit that suits.
std::string time_text(double seconds, int digits = 3) {
  struct Unit {
    double below, scale;
    const char* name;
  };
  static constexpr Unit kUnits[] = {{1e-6, 1e9, "ns"},       {1e-3, 1e6, "µs"},
                                    {1, 1e3, "ms"},          {120, 1, "s"},
                                    {7200, 1.0 / 60, "min"}, {INFINITY, 1.0 / 3600, "h"}};
  const Unit* unit = kUnits;
  while (seconds >= unit->below) ++unit;
  // Rounded first, and then written without an exponent.
  const double value = std::stod(format("{:.{}g}", seconds * unit->scale, digits));
  return format("{:g} {}", value, unit->name);
}

std::string calls_text(const CallTimes& t) {
  return format("median {}, mean {}, 99 % below {}, longest {} ({} calls)", time_text(t.median),
                time_text(t.mean), time_text(t.p99), time_text(t.worst), t.calls);
}

Json calls_json(const CallTimes& t) {
  return {{"calls", t.calls},
          {"median_seconds", t.median},
          {"mean_seconds", t.mean},
          {"p99_seconds", t.p99},
          {"longest_seconds", t.worst}};
}

std::string report_text(const GridSpec& spec, const ModelInfo& info, const ModelCheck& m,
                        const std::optional<GridEstimate>& e, const std::string& no_estimate) {
  const std::string length = info.length_unit.empty() ? "" : " " + printable_line(info.length_unit);
  std::string text = checks_text(m.checks, /*all=*/true) + "\n";
  const auto row = [&](const char* name, const std::string& value) {
    text += left(name, 13) + value + "\n";
  };
  row("d_max",
      format("{}{}; the longest step of this grid, sqrt(3) h, is {}{}", rounded(info.d_max), length,
             rounded(std::sqrt(3.0) * spec.box.spacing), length));
  row("start", time_text(m.start_seconds));
  row("conversion", calls_text(m.convert));
  if (m.force.calls) row("force", calls_text(m.force));
  if (m.shape.calls) row("shape", calls_text(m.shape));
  if (m.force.p99 + m.shape.p99 > kLoopBudget)
    row("", "too slow for a haptic loop: let the grid store them (info.stored)");
  if (m.largest_force > 0) {
    const std::string error = format("; against the energy's gradient off by {} % of that (median)",
                                     rounded(100 * m.median_force_error));
    row("forces",
        format("up to {} N{}", rounded(m.largest_force), info.force_scale > 0 ? error : ""));
  }
  if (!e) {
    row("whole grid", "no estimate, because " + no_estimate);
    return text;
  }
  row("whole grid",
      format("about {} levels a point ({} to {}), {} conversions: about {} ({} to {}) on one core",
             fixed(e->levels.value, 2), fixed(e->levels.least, 2), fixed(e->levels.most, 2),
             e->conversions, time_text(e->cpu_seconds.value, 2), time_text(e->cpu_seconds.least, 2),
             time_text(e->cpu_seconds.most, 2)));
  row("",
      format("from the search of coarser grids of the same box, up to {} points: {} conversions",
             e->points, e->searched));
  row("memory",
      format("play {}, expand up to {}", megabytes(e->play_bytes), megabytes(e->expand_bytes)));
  return text;
}

std::string report_json(const GridSpec& spec, const ModelInfo& info, const ModelCheck& m,
                        const std::optional<GridEstimate>& e) {
  Json json;
  json["version"] = 1;
  json["model"] = spec.model;
  json["verdict"] = is_broken(m.checks) ? "broken" : "fine";
  json["checks"] = checks_json(spec.box, m.checks);
  json["d_max"] = info.d_max;
  json["longest_step"] = std::sqrt(3.0) * spec.box.spacing;
  json["start_seconds"] = m.start_seconds;
  json["convert"] = calls_json(m.convert);
  json["force"] = m.force.calls ? calls_json(m.force) : Json();
  json["shape"] = m.shape.calls ? calls_json(m.shape) : Json();
  json["largest_force_newtons"] = m.largest_force;
  json["median_force_error"] = info.force_scale > 0 ? Json(m.median_force_error) : Json();
  json["grid"] = e ? Json{{"levels", e->levels.value},
                          {"levels_range", {e->levels.least, e->levels.most}},
                          {"conversions", e->conversions},
                          {"cpu_seconds", e->cpu_seconds.value},
                          {"cpu_seconds_range", {e->cpu_seconds.least, e->cpu_seconds.most}},
                          {"points_searched", e->points},
                          {"conversions_searched", e->searched},
                          {"play_bytes", e->play_bytes},
                          {"expand_bytes", e->expand_bytes}}
                   : Json();
  return json_text(json);
}

int run(const Options& options) {
  const Definition definition = load_definition(options.definition, options.output);
  const auto source = model_source(definition, options.definition.file, options.model);
  auto model = source->create(definition.parameters);
  const ModelInfo info = model->info();
  const GridSpec spec = spec_of(definition, *model);
  const Seeds seeds = seed_states(definition, *model);
  model.reset();  // where processes = 1, there is never another one

  const ModelCheck found = check_model(
      spec, seeds, [&] { return create_model(*source, spec); }, options.steps,
      (1 - kEstimateShare) * options.seconds);
  // The time that a broken model takes for a conversion says nothing.
  std::optional<GridEstimate> estimate;
  std::string no_estimate = "a check is broken";
  if (found.convert.calls < kFewestCalls)
    no_estimate = format(
        "too few steps: {} conversion{} tell nothing of the others. --seconds gives "
        "them more time",
        found.convert.calls, found.convert.calls == 1 ? "" : "s");
  else if (!is_broken(found.checks))
    try {
      estimate =
          estimate_grid(definition, *source, kEstimateShare * options.seconds, found.convert.usual);
    } catch (const Error& e) {
      no_estimate = e.what();
      if (!no_estimate.starts_with("too few steps"))
        no_estimate = "the search of a coarser grid failed: " + no_estimate;
    }
  write_text(options.output,
             options.format == "json"
                 ? report_json(spec, info, found, estimate)
                 : printable_text(report_text(spec, info, found, estimate, no_estimate)));
  say("check-model", verdict_line(found.checks));
  return is_fine(found.checks) ? kExitDone : kExitInvalid;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CommandLine app(
      "Tries a model before its grid is searched: walks through the box as a hand would, checks "
      "at\n"
      "each step what the search and the player rely on, and estimates the cost of the whole "
      "grid.");
  app.set_help(
      "check-model",
      "Checks:\n"
      "  felt           a note where the model has no force, or one that nobody feels\n"
      "  spread         a note where states that count as the same are far apart\n"
      "  memory         a note where the model takes ever more\n"
      "  defined        C answers at every step of the grid\n"
      "  deterministic  C, asked again and asked of a second model, answers with the same bits\n"
      "  among          C answers with the same bits when it has several questions at a time\n"
      "  together       the same while two threads ask two models\n"
      "  stays          C(s, x, 0) = s within the tolerance\n"
      "  stable         it comes back from a push of 10 tolerances to one side or to the other\n"
      "  reflexive, symmetric   of the tolerance function\n"
      "  finite         forces and shapes are finite numbers\n"
      "  gradient       the force is the energy's negative gradient, within 2 % of the largest,\n"
      "                 and along each axis within 1 % in all\n"
      "  strong         a note where forces are beyond 100 N\n"
      "  sane           the model finds no mistake in its parameters, where it has a check\n"
      "  halves         9 of 10 steps end in the same state when they are made in two halves\n"
      "  returns        steps there and back end in the same state (no fault)\n"
      "  snaps          where they do not, 9 of 10 end in the same state in 64 pieces\n"
      "\n"
      "Times and the estimate depend on the machine. Everything else depends on the\n"
      "model alone, unless --seconds ends the walks.\n",
      "  3  the model breaks what the search relies on\n");
  add_definition(app, options.definition);
  app.add("--steps", options.steps, "Steps along the walks")
      .type("N")
      .whole(1, std::int64_t{1} << 40)
      .shows_default();
  app.add("--seconds", options.seconds, "Time for all; the estimate takes a quarter of it")
      .type("S")
      .positive()
      .shows_default();
  app.add("--format", options.format, "How the report is written")
      .one_of({"text", "json"})
      .shows_default();
  add_model_options(app, options.model);
  add_output(app, options.output);
  return run_tool(app, argc, argv, [&] {
    report_crashes("check-model");
    return run(options);
  });
}
