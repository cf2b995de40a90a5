// expand: conversions in 26 directions for the records of a frontier.

#include "libcore/search/expand.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>

#include "libcore/base/file.hpp"
#include "libcore/search/complete.hpp"
#include "libcore/shard/writer.hpp"
#include "tools/common/crash.hpp"
#include "tools/common/models.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/serve.hpp"
#include "tools/common/tool.hpp"
#include "tools/expand/request_output.hpp"

namespace {

using namespace hapgrid;

/// Of one run.
struct Options {
  std::vector<std::string> shards;
  std::string output = "-";
  std::string part = "1/1";
  std::string conversions;   // empty: all of the part
  std::uint64_t ranges = 0;  // 0: one shard
  bool complete = false;
  std::string report;
};

/// Of all runs of a process (--serve).
struct StandingOptions {
  ModelOptions model;
  unsigned threads = 1;
  bool progress = false;
};

std::string progress_text(const Progress& progress, const GridSpec& spec, bool complete,
                          double seconds) {
  const double done = static_cast<double>(progress.frontier_done);
  const double all = static_cast<double>(progress.frontier_conversions);
  const double rate = static_cast<double>(progress.conversions) / std::max(seconds, 1e-3);
  std::string text = "expand: generation " + std::to_string(progress.generation) + ", frontier " +
                     short_number(static_cast<double>(progress.frontier_records)) + " records, " +
                     short_number(done) + " of " + short_number(all) + " conversions, " +
                     short_number(rate) + "/s";
  if (complete)
    text += ", " + short_number(static_cast<double>(progress.records)) + " records for " +
            short_number(static_cast<double>(spec.box.points())) + " points";
  else if (rate > 0)
    text += ", " + short_number((all - done) / rate) + " s left";
  return text;
}

/// A:B with A <= B < 2^64.
ConversionRange parse_conversions(const std::string& text) {
  ConversionRange range;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, range.begin);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == ':') {
    const auto second = std::from_chars(first.ptr + 1, end, range.end);
    if (second.ec == std::errc() && second.ptr == end && range.begin <= range.end) return range;
  }
  throw CLI::ValidationError("--conversions", "'" + text + "' is not A:B with A <= B < 2^64");
}

/// The models of the grid at hand.
class LoadedModels {
 public:
  explicit LoadedModels(const StandingOptions& options) : options_(options) {}

  /// Loaded where they are not those of this grid. Starts to count the progress anew.
  Converter& of(const GridSpec& spec) {
    progress.conversions = progress.frontier_done = 0;
    if (converter_ && spec == spec_) return *converter_;
    unload();
    spec_ = spec;
    source_ = model_source(spec, options_.model);
    return converter_.emplace(*source_, spec, options_.threads, progress);
  }
  void unload() {
    converter_.reset();
    source_.reset();
  }

  bool shows_progress() const { return options_.progress; }

  Progress progress;

 private:
  const StandingOptions& options_;
  GridSpec spec_;
  std::unique_ptr<ModelSource> source_;
  std::optional<Converter> converter_;
};

int run(const Options& options, LoadedModels& models, bool stay) {
  const auto [number, of] = parse_part("--part", options.part);
  const Part part{number, of};
  std::optional<ConversionRange> range;
  if (!options.conversions.empty()) range = parse_conversions(options.conversions);
  if (range && part.of != 1)
    throw CLI::ValidationError("--part and --conversions exclude each other");
  if (options.complete && (range || part.of != 1))
    throw CLI::ValidationError("--complete", "works on the whole frontier");
  if (options.complete && options.ranges > 0)
    throw CLI::ValidationError("--ranges", "--complete writes a grid, and no requests");
  if (options.ranges > 0) require_mark("--output", options.output);
  const std::vector<std::string> inputs = inputs_or_stdin(options.shards);
  allow_open_files(inputs.size());
  const std::vector<Section> sections = open_sections(inputs);
  require_lossless(sections);
  SectionHeader header = sections.front().header;
  header.coding = {};
  header.generation = generation_of(sections);
  Progress& progress = models.progress;
  progress.generation = header.generation;

  std::optional<OutputFile> out;  // the grid of --complete
  if (options.complete) out.emplace(options.output);
  std::optional<RequestOutput> requests;
  {
    Converter& converter = models.of(header.spec);
    const ProgressLine line(models.shows_progress(), [&](double seconds) {
      return progress_text(progress, header.spec, options.complete, seconds);
    });
    if (options.complete) {
      complete(sections, converter, progress, [&out](const SectionHeader& finished) {
        return SectionWriter(out->fd(), out->name(), finished);
      });
    } else {
      FrontierReader frontier =
          range ? FrontierReader(sections, *range) : FrontierReader(sections, part);
      progress.frontier_conversions = frontier.conversions();
      progress.frontier_records = 0;
      for (const Section& section : sections) progress.frontier_records += section.footer.frontier;
      header.content = Content::kRequests;
      requests.emplace(options.output, options.ranges, header);
      expand(frontier, converter, header.spec,
             [&requests](PointIndex point, Level level, DirectionMask directions,
                         const double* rows) { requests->add(point, level, directions, rows); });
    }
  }
  if (!stay) models.unload();  // the report counts the time of processes that have ended
  if (out) out->commit();
  if (requests) requests->commit();
  if (!options.report.empty())
    append_report(options.report,
                  {"expand", header.generation, progress.conversions, part.number, part.of});
  return kExitDone;
}

void add_options(CLI::App& app, Options& options) {
  add_inputs(app, options.shards, "Grid, or frontier shards");
  add_output(app, options.output);
  app.add_option(
         "--part", options.part,
         "Only the K-th of N equal parts of the frontier's conversions (1 <= K <= N < 2^32)")
      ->type_name("K/N")
      ->capture_default_str();
  app.add_option("--conversions", options.conversions,
                 "Only the frontier's conversions from A to before B, counted from 0 (--part cuts "
                 "into equal parts without that one has to know how many there are)")
      ->type_name("A:B");
  app.add_option("--ranges", options.ranges,
                 "Write the requests in shards by the range of their target, for merge --range; {} "
                 "in the name of --output becomes the range's number, and a range without requests "
                 "gets no shard")
      ->type_name("R")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000000}));
  app.add_flag("--complete", options.complete,
               "Merge in memory and go on until the frontier is empty; writes the complete grid");
  add_report(app, options.report);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  StandingOptions standing;
  bool serves = false;
  CLI::App app{
      "Evaluates the model's conversion function in 26 directions for each record of the\n"
      "frontier, and writes what was found as requests for merge. Reads a grid, or the frontier\n"
      "shards that merge writes."};
  hapgrid::describe(
      app, "expand",
      "The result does not depend on -j, nor on how the frontier was cut into parts.\n");
  add_options(app, options);
  hapgrid::add_serve(app, serves);
  hapgrid::add_progress(app, standing.progress);
  app.add_option("-j,--threads", standing.threads,
                 "Threads, each with a model (a plug-in or a process) of its own (1 to 1024)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  hapgrid::add_model_options(app, standing.model);
  return hapgrid::run_tool(app, argc, argv, [&] {
    hapgrid::keep_memory();
    hapgrid::report_crashes("expand");
    LoadedModels models(standing);
    if (!serves) return run(options, models, /*stay=*/false);
    return hapgrid::serve(
        "expand", add_options,
        [&models](const Options& line) { return run(line, models, /*stay=*/true); },
        [&models] { models.unload(); });
  });
}
