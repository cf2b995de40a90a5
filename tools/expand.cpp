// expand: conversions in 26 directions for the records of a frontier.

#include "libcore/search/expand.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/base/text.hpp"
#include "libcore/search/complete.hpp"
#include "libcore/search/levels.hpp"
#include "libcore/shard/writer.hpp"
#include "tools/common/crash.hpp"
#include "tools/common/inputs.hpp"
#include "tools/common/models.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/signals.hpp"
#include "tools/common/tool.hpp"
#include "tools/expand/launcher.hpp"

namespace {

using namespace hapgrid;

struct Options {
  std::string grid = "-";
  std::string output = "-";
  std::string part = "1/1";
  bool complete = false;
  unsigned threads = 1;
  std::string cost;
  ModelOptions model;
};

std::string progress_text(const Progress& progress, const GridSpec& spec, bool complete,
                          double seconds) {
  const double done = static_cast<double>(progress.frontier_done);
  const double all = std::max(static_cast<double>(progress.frontier_conversions), 1.0);
  const double rate = static_cast<double>(progress.conversions) / std::max(seconds, 1e-3);
  const double frontier = static_cast<double>(progress.frontier_records);
  const double records = static_cast<double>(progress.records);
  double part = done / all, whole = all;
  if (complete) {  // as if the points that are not reached yet had as many levels as the others
    const double expected = std::max(records, 1.0) * static_cast<double>(spec.box.points()) /
                            std::max(static_cast<double>(progress.points), 1.0);
    part = (records - frontier * (1 - done / all)) / expected;
    whole = kDirections * expected;
  }
  const std::string begin = "expand: " + part_done(part, rate / whole);
  if (complete)
    return format("{}, generation {}, {} records found, {} conversions/s", begin,
                  progress.generation.load(), short_number(records), short_number(rate));
  return format("{}, {} of {} conversions, {}/s", begin, short_number(done), short_number(all),
                short_number(rate));
}

/// Tells of the file that keeps what is found. A line of progress would be in the way.
void say_beside_progress(const std::string& text) {
  if (::isatty(STDERR_FILENO)) static_cast<void>(std::fputs("\r\033[K", stderr));
  say("expand", text);
}

/// Where a whole generation is kept: beside a file, nowhere when the grid goes to a pipe.
std::optional<PartialGrid> partial_of(const Options& options) {
  namespace fs = std::filesystem;
  const bool beside =
      options.output != "-" && (!fs::exists(options.output) || fs::is_regular_file(options.output));
  if (!options.complete || !beside) return std::nullopt;
  return PartialGrid(options.output + ".partial", say_beside_progress);
}

constexpr char kOverProgress[] =
    "\r\033[Kexpand: stops after the conversions that are under way; once more: at once\n";
constexpr const char* kNotice = kOverProgress + sizeof "\r\033[K" - 1;

void write_complete(const Section& grid, Converter& converter, Progress& progress, OutputFile& out,
                    PartialGrid* partial) {
  complete(
      grid, converter, progress,
      [&out](const SectionHeader& finished) {
        return SectionWriter(out.fd(), out.name(), finished);
      },
      partial);
}

void write_requests(const Section& grid, Part part, Converter& converter, Progress& progress,
                    OutputFile& out) {
  FrontierReader frontier(grid, part);
  progress.frontier_conversions = frontier.conversions();
  progress.frontier_records = grid.frontier();
  const SectionHeader header{Content::kRequests, grid.header.generation, grid.header.spec};
  SectionWriter requests(out.fd(), out.name(), header);
  expand([&](FrontierRecord& record) { return frontier.next(record); }, converter, header.spec,
         [&](const FrontierRecord& from, const double* rows) {
           requests.requests(from.point, from.level, from.todo, rows);
         });
  requests.finish();
}

/// "auto", or "K/N" with 1 <= K <= N < 2^32, which keeps the arithmetic of cutting inside 64 bits.
Part part_of(const std::string& text) {
  if (text == "auto") return part_of_launcher();
  Part part;
  if (!parse_two(text, '/', part.number, part.of) || part.number < 1 || part.number > part.of ||
      part.of >= std::uint64_t{1} << 32)
    throw UsageError(format("--part: '{}' is not K/N with 1 <= K <= N < 2^32", text));
  return part;
}

/// Is there a file `name` with what expand makes of `grid`? @throw FormatError when it holds
/// something else
bool is_there(const std::string& name, const Section& grid) {
  if (!std::filesystem::exists(name)) return false;
  for (const Section& section : open_sections({name})) {
    const SectionHeader& header = section.header;
    if (header.content != Content::kRequests || header.generation != grid.header.generation ||
        !(header.spec == grid.header.spec))
      throw FormatError(format(
          "{} is there already, and holds no requests for generation {} of this grid: remove it "
          "first",
          name, grid.header.generation));
  }
  return true;
}

/// Tells of the work in the file of --cost. `failed`: see RunCost.
void tell_cost(const Options& options, std::uint32_t generation, Part part,
               const Progress& progress, const char* failed = "") {
  if (options.cost.empty()) return;
  append_cost(options.cost,
              {"expand", generation, progress.conversions, part.number, part.of, failed});
}

int run(const Options& options) {
  const Part part = part_of(options.part);
  if (options.complete && part.of != 1) throw UsageError("--complete: works on the whole frontier");
  keep_inputs({{"--output", options.output},
               {"--output", options.complete ? options.output + ".partial" : ""},
               {"--cost", options.cost}},
              {{options.grid, "grid"}, {options.model.allowed, "definition"}});
  announce_terminal(options.grid);
  const Section grid = open_grid(options.grid);
  const GridSpec& spec = grid.header.spec;
  Progress progress;
  progress.generation = grid.header.generation;
  const std::string output =
      options.complete ? options.output : named_by_part(options.output, part);
  if (output != options.output && is_there(output, grid)) return kExitDone;
  std::optional<PartialGrid> partial = partial_of(options);
  std::optional<CaughtSignals> signals;
  if (partial) {  // a signal ends the search in good order, and the message says what is kept
    progress.stop = &caught_signal;
    signals.emplace(CaughtSignals::kEnding, ::isatty(STDERR_FILENO) ? kOverProgress : kNotice);
  }
  OutputFile out(output);
  const Section start = partial ? partial->start(grid) : grid;
  if (partial && partial->kept())
    say("expand",
        format("goes on from generation {}, which {} keeps", *partial->kept(), partial->name()));
  try {
    const std::unique_ptr<ModelSource> source = model_source(spec, options.model);
    const unsigned threads =
        options.threads > 0 ? options.threads : static_cast<unsigned>(all_threads());
    Converter converter(*source, spec, threads, progress);
    if (converter.models() < threads)
      say("expand", format("the model wants no more than {} of the {} threads (processes = {}); "
                           "hapgrid rounds --parts N uses more processors",
                           converter.models(), threads, converter.models()));
    const ProgressLine line(
        [&](double seconds) { return progress_text(progress, spec, options.complete, seconds); });
    if (options.complete)
      write_complete(start, converter, progress, out, partial ? &*partial : nullptr);
    else
      write_requests(grid, part, converter, progress, out);
  } catch (const Stopped& e) {
    say("expand", e.what());
    return 128 + caught_signal.load();
  } catch (const LevelLimit&) {
    tell_cost(options, grid.header.generation, part, progress, "levels");
    throw;
  } catch (const ModelError&) {
    tell_cost(options, grid.header.generation, part, progress, "model");
    throw;
  }  // the cost counts the time of processes that have ended
  out.commit();
  if (partial) partial->remove();
  tell_cost(options, grid.header.generation, part, progress);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CommandLine app{
      "Evaluates the model's conversion function in 26 directions for each record of the\n"
      "frontier of a grid, and writes what was reached as requests for merge."};
  app.set_help("expand",
               "The result does not depend on -j, nor on how the frontier was cut into parts.\n");
  add_grid(app, options.grid);
  add_output(app, options.output);
  app.add("--part", options.part,
          "Only the K-th of N equal parts of the round (1 <= K <= N < 2^32), or 'auto': the "
          "part that srun, a job array of Slurm or mpirun gives this process. {} in the name "
          "of --output becomes K-of-N, and a part whose file is there is not computed again")
      .type("K/N|auto")
      .shows_default();
  app.add_flag("--complete", options.complete,
               "Merge in memory and go on until nothing is left to do; write the finished grid. "
               "FILE.partial keeps a generation meanwhile, from which the same command goes on");
  app.add("-j,--threads", options.threads,
          "Threads, each with a model (a plug-in or a process) of its own (0 to 1024); 0: one for "
          "each processor that it may use")
      .type("N")
      .whole(0, 1024)
      .shows_default();
  add_cost(app, options.cost);
  add_model_options(app, options.model);
  return run_tool(app, argc, argv, [&] {
    keep_memory();
    report_crashes("expand");
    return run(options);
  });
}
