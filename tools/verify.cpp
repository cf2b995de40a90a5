// verify: whether a grid is what Algorithm 1 promises, and what the model says today.

#include <charconv>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/check/part_report.hpp"
#include "libcore/check/report.hpp"
#include "tools/common/models.hpp"
#include "tools/common/tool.hpp"
#include "tools/verify/examine.hpp"

using namespace hapgrid;

namespace {

struct Options {
  std::vector<std::string> inputs;
  Examination asked;
  std::string recompute = "1000";
  std::string part;    // empty: all of it, and a report for people
  bool merge = false;  // the inputs are reports of parts
  std::string format = "text";
  std::string output = "-";
};

constexpr std::uint64_t kMostWalks = 1'000'000;
// Of a part: some 2 KB a walk, and next to nothing else.
constexpr std::uint64_t kMostReportBytes = std::uint64_t{1} << 32;
constexpr std::uint64_t kDefaultWalks = 100;

/// How many records --recompute asks for; false when it is none of all, none and a number.
bool parse_recompute(const std::string& text, std::uint64_t& count) {
  count = text == "all" ? std::numeric_limits<std::uint64_t>::max() : 0;
  if (text == "all" || text == "none") return true;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, count);
  return read.ec == std::errc() && read.ptr == end;
}

std::vector<PartReport> read_parts(const std::vector<std::string>& names) {
  std::vector<PartReport> parts;
  for (const std::string& name : names)
    parts.push_back(part_from_json(read_text(name, kMostReportBytes), name));
  return parts;
}

void write(const Options& options, const std::string& text) {
  OutputFile output(options.output, /*binary=*/false);
  output.write(text);
  output.commit();
}

/// The report of all parts.
int conclude(const Options& options, std::vector<PartReport> parts,
             const std::vector<std::string>& names) {
  const GridSummary grid = parts.at(0).grid;
  const std::vector<Check> checks = join(std::move(parts), names);
  write(options, options.format == "json" ? report_json(grid, checks) : report_text(grid, checks));
  std::fprintf(stderr, "verify: %s\n", verdict_line(checks).c_str());
  return is_fine(checks) ? kExitDone : kExitInvalid;
}

int run(const Options& options) {
  const std::vector<std::string> inputs = inputs_or_stdin(options.inputs);
  if (options.merge) return conclude(options, read_parts(inputs), inputs);

  Examination asked = options.asked;
  if (inputs.size() > 1) throw CLI::ValidationError("a grid is one shard");
  asked.grid = inputs.front();
  parse_recompute(options.recompute, asked.recompute);
  if (asked.accuracy && asked.walks == 0) asked.walks = kDefaultWalks;
  if (options.part.empty()) return conclude(options, {examine(asked)}, {"the grid"});

  const auto [number, of] = parse_part("--part", options.part);
  asked.part = {number, of};
  const PartReport part = examine(asked);
  write(options, part_to_json(part));
  std::fprintf(stderr, "verify: part %s: %s\n", options.part.c_str(),
               verdict_line(part.checks).c_str());
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Checks a whole grid: the streams, what Algorithm 1 promises of every record, and C itself\n"
      "evaluated again. The report goes to standard output, the verdict to standard error.");
  Options options;
  Examination& asked = options.asked;
  add_inputs(app, options.inputs, "A grid; reports with --merge");
  app.add_option("--recompute", options.recompute,
                 "Records for which C is evaluated again in all 26 directions: all, none, or how "
                 "many to draw as a sample")
      ->type_name("all|N|none")
      ->check([](const std::string& text) {
        std::uint64_t count = 0;
        return parse_recompute(text, count) ? "" : "'" + text + "' is not all, none or a number";
      })
      ->capture_default_str();
  app.add_option("--sample-seed", asked.sample_seed,
                 "Draws another sample; the same number draws the same records everywhere")
      ->type_name("S")
      ->capture_default_str();
  app.add_option(
         "--walks", asked.walks,
         "Random walks of the hand for `accurate`, of some 600 conversions each, by the same "
         "S (default: none; with --accuracy " +
             std::to_string(kDefaultWalks) + ")")
      ->type_name("N")
      ->check(CLI::Range(std::uint64_t{1}, kMostWalks));
  app.add_option("--accuracy", asked.accuracy,
                 "The error of the state between grid points that is wanted, in the tolerance "
                 "function's unit: more in one of 100 places is a fault")
      ->type_name("E")
      ->check(CLI::PositiveNumber);
  app.add_option("-j,--threads", asked.threads, "Threads; the report does not depend on it")
      ->type_name("N")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--damping", asked.rendering.damping,
                 "Of the device on which `steep` judges stability, in N s/m")
      ->type_name("B")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--rate", asked.rendering.rate_hz, "Its ticks a second")
      ->type_name("HZ")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option(
         "--scale", asked.rendering.scale,
         "Metres of the hand in the model's unit of length (default: the smallest stable one "
         "is reported)")
      ->type_name("M")
      ->check(CLI::PositiveNumber);
  CLI::Option* const format =
      app.add_option("--format", options.format, "How the report is written")
          ->check(CLI::IsMember({"text", "json"}))
          ->capture_default_str();
  CLI::Option* const part =
      app.add_option("--part", options.part,
                     "Only the K-th of N parts of the checks (1 <= K <= N < 2^32); writes what it "
                     "found, for --merge, which has the verdict")
          ->type_name("K/N")
          ->excludes(format);
  app.add_flag("--merge", options.merge,
               "The inputs are what all the parts wrote: the report, verdict and exit code of one "
               "run over all of it")
      ->excludes(part);
  for (const char* other : {"--recompute", "--sample-seed", "--walks", "--accuracy",
                            "--damping", "--rate", "--scale"})
    app.get_option("--merge")->excludes(app.get_option(other));
  add_model_options(app, asked.model);
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
      "               renders them stably: K < 2 B HZ\n"
      "Between the grid's points, on samples, when it is asked for:\n"
      "  accurate     random walks of the hand: play's state and force against the model, followed "
      "in\n"
      "               small steps. A fault only with --accuracy, which also says which spacing it\n"
      "               takes; where branches mix or end, places are counted and not judged\n"
      "Parts: all share the work of fidelity, stored, accurate, and of what looks at one point "
      "after\n"
      "the other; the first has the rest, which takes the whole grid. Each reads all of the "
      "grid.\n",
      "  3  read everything, and an invariant is broken\n");
  return run_tool(app, argc, argv, [&] { return run(options); });
}
