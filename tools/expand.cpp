// expand: conversions in 26 directions for the records of a frontier.

#include "libcore/search/expand.hpp"

#include <algorithm>
#include <charconv>
#include <memory>
#include <thread>

#include "libcore/base/file.hpp"
#include "libcore/search/complete.hpp"
#include "tools/common/crash.hpp"
#include "tools/common/models.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/tool.hpp"

namespace {

using namespace hapgrid;

struct Options {
  std::vector<std::string> shards;
  std::string output = "-";
  ModelOptions model;
  unsigned threads = 1;
  std::string part = "1/1";
  bool complete = false;
  bool progress = false;
  std::string report;
};

/// "K/N" with 1 <= K <= N. N below 2^32 keeps the arithmetic of cutting a frontier inside 64 bits.
Part parse_part(const std::string& text) {
  Part part;
  const char* end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, part.number);
  if (number.ec == std::errc() && number.ptr != end && *number.ptr == '/') {
    const auto of = std::from_chars(number.ptr + 1, end, part.of);
    if (of.ec == std::errc() && of.ptr == end && part.number >= 1 && part.number <= part.of &&
        part.of < std::uint64_t{1} << 32)
      return part;
  }
  throw CLI::ValidationError("--part", "'" + text + "' is not K/N with 1 <= K <= N < 2^32");
}

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

int run(const Options& options) {
  report_crashes("expand");
  const Part part = parse_part(options.part);
  if (options.complete && part.of != 1)
    throw CLI::ValidationError("--part", "--complete works on the whole frontier");
  const std::vector<std::string> inputs = inputs_or_stdin(options.shards);
  allow_open_files(inputs.size());
  const std::vector<Section> sections = open_sections(inputs);
  SectionHeader header = sections.front().header;
  const std::uint32_t first_generation = header.generation;
  const auto source = model_source(header.spec, options.model);
  Progress progress;
  progress.generation = header.generation;

  OutputFile out(options.output);
  {
    Converter converter(*source, header.spec, options.threads, progress);
    const ProgressLine line(options.progress, [&](double seconds) {
      return progress_text(progress, header.spec, options.complete, seconds);
    });
    if (options.complete) {
      complete(sections, converter, progress, [&out](const SectionHeader& finished) {
        return SectionWriter(out.fd(), out.name(), finished);
      });
    } else {
      FrontierReader frontier(sections, part);
      progress.frontier_conversions = frontier.conversions();
      for (const Section& section : sections) progress.frontier_records += section.footer.frontier;
      header.content = Content::kRequests;
      SectionWriter writer(out.fd(), out.name(), header);
      expand(frontier, converter, header.spec, writer);
      writer.finish();
    }
  }
  out.commit();
  if (!options.report.empty())
    append_report(options.report,
                  {"expand", first_generation, progress.conversions, part.number, part.of});
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Evaluates the model's conversion function in 26 directions for each record of the\n"
      "frontier, and writes what was found as requests for merge. Reads a grid, or the frontier\n"
      "shards that merge writes."};
  hapgrid::describe(
      app, "expand",
      "The result does not depend on -j, nor on how the frontier was cut into parts.\n");
  hapgrid::add_inputs(app, options.shards, "Grid, or frontier shards");
  hapgrid::add_output(app, options.output);
  app.add_option("-j,--threads", options.threads,
                 "Threads, each with a model (a plug-in or a process) of its own (1 to 1024)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option(
         "--part", options.part,
         "Only the K-th of N equal parts of the frontier's conversions (1 <= K <= N < 2^32)")
      ->type_name("K/N")
      ->capture_default_str();
  app.add_flag("--complete", options.complete,
               "Merge in memory and go on until the frontier is empty; writes the complete grid");
  hapgrid::add_run_options(app, options.report, options.progress);
  hapgrid::add_model_options(app, options.model);
  return hapgrid::run_tool(app, argc, argv, [&] { return run(options); });
}
