// verify: whether a grid is what Algorithm 1 promises, and what the model says today.

#include <atomic>
#include <charconv>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/check/configurations.hpp"
#include "libcore/check/fidelity.hpp"
#include "libcore/check/forces.hpp"
#include "libcore/check/invariants.hpp"
#include "libcore/check/passive.hpp"
#include "libcore/check/paths.hpp"
#include "libcore/check/precision.hpp"
#include "libcore/check/report.hpp"
#include "libcore/check/steep.hpp"
#include "libcore/model/model.hpp"
#include "libcore/search/converter.hpp"
#include "libcore/shard/load.hpp"
#include "tools/common/models.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/tool.hpp"

using namespace hapgrid;

namespace {

struct Options {
  std::vector<std::string> shards;
  std::string recompute = "1000";
  std::string against;
  std::uint64_t sample_seed = 1;
  int threads = 1;
  std::string format = "text";
  Rendering rendering;
  ModelOptions model;
  std::string output = "-";
};

/// How many records --recompute asks for; false when it is none of all, none and a number.
bool parse_recompute(const std::string& text, std::uint64_t& count) {
  count = text == "all" ? std::numeric_limits<std::uint64_t>::max() : 0;
  if (text == "all" || text == "none") return true;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, count);
  return read.ec == std::errc() && read.ptr == end;
}

int run(const Options& options) {
  const std::vector<std::string> inputs = inputs_or_stdin(options.shards);
  if (!options.against.empty()) {
    std::vector<std::string> both = inputs;
    both.push_back(options.against);
    inputs_or_stdin(both);  // refuses standard input twice
  }
  const LoadedGrid loaded = load_grid(inputs);
  const Grid& grid = loaded.grid;
  std::uint64_t count = 0;
  parse_recompute(options.recompute, count);
  const auto source =
      count > 0 ? model_source(grid.spec(), options.model, " (or leave C out: --recompute none)")
                : nullptr;
  const auto make_model = [&] {
    return forgiving(model_functions(create_model(*source, grid.spec())), loaded);
  };
  const auto judge = [&] { return judging_model(grid.spec(), options.model.path); };
  Model model = judge();
  const bool wants_forces = has_force(grid.spec(), model);
  const SameState same = same_in_spite_of(model_functions(std::move(model)).same, loaded);

  std::vector<Check> checks{check_complete(grid), check_coverage(grid), check_links(grid),
                            check_finite(grid), check_distinct(grid, same)};
  for (Check& check : check_reachable(grid)) checks.push_back(std::move(check));
  if (count > 0) {
    const auto sample = sample_records(grid, count, options.sample_seed);
    std::atomic<std::uint64_t> done{0};
    const ProgressLine progress(false, [&](double) {
      return "verify: fidelity: " + std::to_string(done) + " of " + std::to_string(sample.size()) +
             " records";
    });
    checks.push_back(check_fidelity(grid, sample, make_model, options.threads, done));
    if (grid.spec().row_size() > grid.state_size()) {
      checks.push_back(check_stored(grid, sample, make_model, options.threads));
      // A force may be any number of times as sensitive as the state that it is evaluated from.
      checks.back().is_note = loaded.coding.is_lossy();
    }
  }
  if (!options.against.empty())
    checks.push_back(check_precision(loaded, load_grid({options.against})));
  else if (loaded.coding.is_lossy())
    checks.push_back(check_precision(loaded));
  checks.push_back(check_blends(grid));
  const CellMap map(grid, options.threads);
  const Configurations found =
      find_configurations(grid, map, options.threads, default_configuration_limit(map));
  for (Check& check : check_paths(grid, map, found, options.threads))
    checks.push_back(std::move(check));
  std::optional<Forces> forces;
  if (wants_forces) forces.emplace(grid, judge, options.threads);
  checks.push_back(check_steep(grid, map, found, forces ? &*forces : nullptr, options.rendering,
                               options.threads));
  if (forces) {
    checks.push_back(check_passive(grid, map, found, *forces, options.threads));
    // Its bound is for forces of the model's own states.
    if (loaded.coding.is_lossy()) checks.back().is_note = true;
  }

  OutputFile output(options.output, /*binary=*/false);
  output.write(options.format == "json" ? report_json(grid, checks) : report_text(grid, checks));
  output.commit();
  std::fprintf(stderr, "verify: %s\n", verdict_line(checks).c_str());
  return is_fine(checks) ? kExitDone : kExitInvalid;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Checks a whole grid: the streams, what Algorithm 1 promises of every record, and C itself\n"
      "evaluated again. The report goes to standard output, the verdict to standard error.");
  Options options;
  add_inputs(app, options.shards, "Shards that hold one grid together");
  app.add_option("--recompute", options.recompute,
                 "Records for which C is evaluated again in all 26 directions: all, none, or how "
                 "many to draw as a sample")
      ->type_name("all|N|none")
      ->check([](const std::string& text) {
        std::uint64_t count = 0;
        return parse_recompute(text, count) ? "" : "'" + text + "' is not all, none or a number";
      })
      ->capture_default_str();
  app.add_option("--against", options.against,
                 "The grid that this one was coded from (merge --final): compares all records")
      ->type_name("ORIGINAL");
  app.add_option("--sample-seed", options.sample_seed,
                 "Draws another sample; the same number draws the same records everywhere")
      ->type_name("S")
      ->capture_default_str();
  app.add_option("-j,--threads", options.threads, "Threads; the report does not depend on it")
      ->type_name("N")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--damping", options.rendering.damping,
                 "Of the device on which `steep` judges stability, in N s/m")
      ->type_name("B")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--rate", options.rendering.rate_hz, "Its ticks a second")
      ->type_name("HZ")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option(
         "--scale", options.rendering.scale,
         "Metres of the hand in the model's unit of length (default: the smallest stable one "
         "is reported)")
      ->type_name("M")
      ->check(CLI::PositiveNumber);
  app.add_option("--format", options.format, "How the report is written")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  add_model_options(app, options.model);
  add_output(app, options.output);
  describe(
      app, "verify",
      "Checks:\n"
      "  complete     no record is left in the frontier\n"
      "  coverage     each point of the box has a level\n"
      "  links        directions lead to levels that exist, or are marked as leaving the box\n"
      "  finite       states, and what is stored with them, are finite numbers\n"
      "  distinct     levels of a point differ by more than the tolerance function forgives\n"
      "  reachable    links lead to each record from the seeds (generation 0)\n"
      "  generations  a record's generation is its distance from the seeds, in links; the\n"
      "               levels of a point ascend with it\n"
      "  fidelity     C(s, x, d), evaluated again, is the state where the link leads\n"
      "  stored       force, energy and shape, evaluated again, are what is stored\n"
      "  precision    of a grid of merge --precision: its bounds fit its numbers; --against:\n"
      "               all numbers are within them. distinct and fidelity then forgive what\n"
      "               the bounds explain, and stored and passive are no faults\n"
      "  blends       (no fault) cells where play may mix branches, near tear-offs\n"
      "What play can do, proved over every configuration (a cell with the levels of its corners)\n"
      "that any motion of the hand leads to, not over samples:\n"
      "  paths        no start and no cell switch needs a link that is missing\n"
      "  continuous   switches keep the common vertices, so the state never jumps\n"
      "  passive      no closed walk of the hand along links gains more energy than the\n"
      "               spacing explains; the largest loss, the largest turn inside a cell\n"
      "  mixed        (no fault) configurations of several branches, and how far these are apart\n"
      "  one-way      (no fault) configurations that a switch leaves with no way straight back\n"
      "  steep        (no fault) the largest slopes of state and force, and whether the device\n"
      "               renders them stably: K < 2 B HZ\n",
      "  3  read everything, and an invariant is broken\n");
  return run_tool(app, argc, argv, [&] { return run(options); });
}
