// verify: whether a grid is what Algorithm 1 promises, and what the model says today.

#include <limits>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/check/report.hpp"
#include "libcore/shard/reader.hpp"
#include "tools/common/inputs.hpp"
#include "tools/common/models.hpp"
#include "tools/common/tool.hpp"
#include "tools/verify/examine.hpp"

using namespace hapgrid;

namespace {

constexpr const char* kDefaultRecompute = "1000";

struct Options {
  std::string grid = "-";
  Examination asked;
  std::string recompute = kDefaultRecompute;
  std::string format = "text";
  std::string output = "-";
  bool is_verbose = false;
};

constexpr std::uint64_t kMostWalks = 1'000'000;
constexpr std::uint64_t kDefaultWalks = 100;

constexpr const char* kChecks =
    "The rows of the report:\n"
    "  complete, coverage, links, finite, distinct\n"
    "               all points, states and links are there\n"
    "  reachable, generations\n"
    "               links lead from the seeds to each record, as far as its generation\n"
    "  fidelity, stored\n"
    "               the model, asked again, gives what the grid has\n"
    "  stable       states come back from a push, and are on no barrier's top\n"
    "  snaps        the model snaps at the same links in short pieces, and does not leap\n"
    "  continuous   the state jumps nowhere but where it snaps\n"
    "  gradient, steep\n"
    "               notes: force and energy; slopes, and what the device renders stably\n"
    "  passive      no closed walk of the hand gains energy: no snap leads up\n"
    "  accurate     --walks: the error between points; a fault with --accuracy only\n";

/// How many records --recompute asks for; false for anything but "all", "none" and a number.
bool parse_recompute(const std::string& text, std::uint64_t& count) {
  count = text == "all" ? std::numeric_limits<std::uint64_t>::max() : 0;
  return text == "all" || text == "none" || parse_number(text, count);
}

std::string report(const Grid& grid, const std::vector<Check>& checks, const Options& options) {
  if (options.format == "json") return report_json(grid, checks);
  return printable_text(report_text(grid, checks, options.is_verbose));
}

/// Writes the report and the verdict. @returns the exit code
int tell(const Grid& grid, const std::vector<Check>& checks, const Options& options) {
  write_text(options.output, report(grid, checks, options));
  say("verify", verdict_line(checks));
  return is_broken(checks) ? kExitInvalid : is_fine(checks) ? kExitDone : kExitNotProved;
}

bool asks_no_model(const Options& options) {
  return options.recompute == "none" && options.asked.walks == 0 && !options.asked.accuracy;
}

int run(const Options& options) {
  Examination asked = options.asked;
  parse_recompute(options.recompute, asked.recompute);
  if (asked.accuracy && asked.walks == 0) asked.walks = kDefaultWalks;
  keep_inputs({{"--output", options.output}},
              {{options.grid, "grid"}, {asked.model.allowed, "definition"}});
  announce_terminal(options.grid);
  const Grid grid = load_grid(options.grid);
  return tell(grid, examine(grid, asked), options);
}

void add_checks(CommandLine& app, Options& options) {
  Examination& asked = options.asked;
  app.group("Checks");
  app.add("--recompute", options.recompute,
          "Records whose conversions are evaluated again, as a random sample")
      .type("all|N|none")
      .check(
          [](const std::string& text) {
            std::uint64_t count = 0;
            return parse_recompute(text, count);
          },
          "all, none or a number")
      .shows_default();
  app.add("--walks", asked.walks,
          "Random walks of the hand, about 600 conversions each (default: none)")
      .type("N")
      .whole(1, kMostWalks);
  app.add("--accuracy", asked.accuracy,
          format("Fault: 1 % of the walked places are off by more; sets --walks {}", kDefaultWalks))
      .type("E")
      .positive();
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Checks a whole grid: what Algorithm 1 promises of every record, what play can do in it, "
      "and\n"
      "C itself evaluated again. The report goes to standard output, the verdict to standard "
      "error.");
  Options options;
  add_grid(app, options.grid);
  add_checks(app, options);
  app.group("The model");
  add_model_options(app, options.asked.model);
  app.group("Options");
  app.add("-j,--threads", options.asked.threads, "Threads; the report is the same")
      .type("N")
      .whole(1, 1024)
      .shows_default();
  app.add("--format", options.format, "How the report is written")
      .one_of({"text", "json"})
      .shows_default();
  add_output(app, options.output);
  app.add_flag("-v,--verbose", options.is_verbose,
               "Figures and places of every check that has some");
  app.set_help("verify", kChecks,
               "  3  read everything, and an invariant is broken\n"
               "  4  nothing is broken, but a check could not prove what it says\n");
  return run_tool(app, argc, argv, [&] {
    if (asks_no_model(options) && app.given("--allow-process"))
      throw UsageError("--allow-process: --recompute none, and no --walks, ask no model");
    return run(options);
  });
}
