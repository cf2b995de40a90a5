// merge: a generation's requests into the grid.

#include "libcore/search/merge.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/search/frontier.hpp"
#include "libcore/shard/finish.hpp"
#include "tools/common/models.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/serve.hpp"
#include "tools/common/tool.hpp"

namespace {

using namespace hapgrid;

struct Options {
  std::vector<std::string> shards;
  std::string output = "-";
  std::string tip;
  bool layer = false;
  std::string frontier;
  std::uint64_t parts = 1;
  std::string range = "1/1";
  std::string counts;
  bool final = false;
  double precision = 0;
  std::string report;
};

/// Of all runs of a process (--serve).
struct StandingOptions {
  std::vector<std::string> model_path;
  bool progress = false;
};

/// The model of the grid at hand.
class LoadedModel {
 public:
  explicit LoadedModel(const StandingOptions& options) : options_(options) {}

  /// Loaded where it is not that of this grid.
  const Model& of(const GridSpec& spec) {
    if (!model_ || spec != spec_) {
      unload();
      model_ = judging_model(spec, options_.model_path);
      spec_ = spec;
    }
    return *model_;
  }
  void unload() { model_.reset(); }
  bool shows_progress() const { return options_.progress; }

 private:
  const StandingOptions& options_;
  GridSpec spec_;
  std::unique_ptr<Model> model_;
};

/// A frontier that is one shard needs no place for a number in its name.
std::string frontier_name(const Options& options, std::uint64_t part) {
  const bool plain = options.parts == 1 && options.frontier.find("{}") == std::string::npos;
  return plain ? options.frontier : numbered(options.frontier, part);
}

/// Cuts the frontier that was collected in `file` into shards of equally many conversions.
void write_parts(const std::shared_ptr<const InputFile>& file, const Options& options) {
  const std::vector<Section> sections = open_sections(file);
  const SectionHeader& header = sections.front().header;
  for (std::uint64_t part = 1; part <= options.parts; ++part) {
    OutputFile out(frontier_name(options, part));
    SectionWriter writer(out.fd(), out.name(), header);
    FrontierReader frontier(sections, Part{part, options.parts});
    FrontierReader::Record record;
    while (frontier.next(record))
      writer.frontier(record.point, record.level, record.state, record.todo);
    writer.finish();
    out.commit();
  }
}

/// The finished grid in its coded form.
void write_final(const MergeInput& input, const Options& options) {
  if (!input.requests().empty())
    throw Error(input.requests().front().file->name() + ": requests; --final takes a grid alone");
  if (input.conversions() > 0)
    throw Error(input.grid().front().file->name() + ": " + std::to_string(input.conversions()) +
                " conversions are still to be done; --final takes a grid that is complete");
  SectionHeader header = input.merged_header();
  header.coding = final_coding(input.grid(), options.precision);
  OutputFile out(options.output);
  SectionWriter writer(out.fd(), out.name(), header);
  copy_records(input.grid(), writer);
  out.commit();
}

int run(const Options& options, LoadedModel& loaded) {
  const bool cut = !options.frontier.empty();
  const bool in_parts = cut && options.parts > 1;
  if (in_parts) require_mark("--frontier", options.frontier);
  const auto [number, of] = parse_part("--range", options.range);
  if (cut && options.final) throw CLI::ValidationError("--final and --frontier exclude each other");
  const bool apart = !options.tip.empty();
  if (options.layer && !apart) throw CLI::ValidationError("--layer needs --tip");
  if (apart && options.final) throw CLI::ValidationError("--final and --tip exclude each other");
  if (!options.counts.empty() && options.final)
    throw CLI::ValidationError("--final and --counts exclude each other");
  if (options.precision > 0 && !options.final)
    throw CLI::ValidationError("--precision needs --final");
  const std::vector<std::string> inputs = inputs_or_stdin(options.shards);
  allow_open_files(inputs.size());
  const MergeInput input(open_sections(inputs));
  if (options.final) {
    write_final(input, options);
    if (!options.report.empty())
      append_report(options.report, {"merge", input.generation(), 0, 1, 1});
    return kExitDone;
  }
  if (options.layer) input.require_layers();
  const Model& model = loaded.of(input.spec());
  const SectionHeader header = input.merged_header();
  SectionHeader frontier_header = header;
  frontier_header.content = Content::kFrontier;

  OutputFile out(options.output);
  SectionWriter writer(out.fd(), out.name(), header, options.layer ? Cut::kByRows : Cut::kByPoints);
  std::optional<OutputFile> tip_file;
  std::optional<SectionWriter> tip;
  if (apart) {
    tip_file.emplace(options.tip);
    tip.emplace(tip_file->fd(), tip_file->name(), header, Cut::kByRows);
  }
  std::optional<SectionWriter> frontier;
  std::optional<OutputFile> whole;
  FileDescriptor collected;
  if (cut && !in_parts) {
    whole.emplace(frontier_name(options, 1));
    frontier.emplace(whole->fd(), whole->name(), frontier_header);
  } else if (cut) {
    // How to cut the frontier is known only when all of it is: it waits in a file without a name.
    const auto directory = std::filesystem::path(options.frontier).parent_path();
    collected = unlinked_file(directory.empty() ? "." : directory);
    frontier.emplace(collected.get(), options.frontier, frontier_header);
  }
  Progress progress;
  NewRecords stored;
  {
    const ProgressLine line(loaded.shows_progress(), [&](double seconds) {
      const double done = static_cast<double>(progress.conversions);
      return "merge: generation " + std::to_string(header.generation) + ", " + short_number(done) +
             " of " + short_number(static_cast<double>(input.conversions())) + " requests, " +
             short_number(done / std::max(seconds, 1e-3)) + "/s";
    });
    stored = merge(input, of == 1 ? PointRange{} : point_range(input.spec(), number, of), model,
                   {writer, tip ? &*tip : nullptr, options.layer, frontier ? &*frontier : nullptr},
                   progress);
  }
  // The grid appears last: where it is, its frontier is too.
  if (tip_file) tip_file->commit();
  if (whole) whole->commit();
  if (in_parts)
    write_parts(std::make_shared<const InputFile>(std::move(collected), options.frontier), options);
  out.commit();
  if (!options.counts.empty()) {
    OutputFile counts(options.counts, /*binary=*/false);
    counts.write(std::to_string(number) + "\t" + std::to_string(stored.points) + "\t" +
                 std::to_string(stored.records) + "\t" + std::to_string(stored.conversions) + "\n");
    counts.commit();
  }
  if (!options.report.empty())
    append_report(options.report, {"merge", header.generation, 0, number, of});
  return kExitDone;
}

void add_options(CLI::App& app, Options& options) {
  add_inputs(app, options.shards, "The grid and all requests of its frontier");
  add_output(app, options.output);
  app.add_option("--tip", options.tip,
                 "Write the records of the new frontier to FILE, a shard of the grid, and not to "
                 "--output, which then never changes again")
      ->type_name("FILE");
  app.add_flag("--layer", options.layer,
               "With --tip: write only the records that this merge settles to --output. The grid "
               "is then all such layers and the last tip; a merge of them all makes it one shard");
  app.add_option("--frontier", options.frontier,
                 "Write the new frontier too, as --parts shards; {} in PATTERN becomes the part's "
                 "number, from 1 (one part needs no {})")
      ->type_name("PATTERN");
  app.add_option("--parts", options.parts, "Number of frontier shards (1 to 1000000)")
      ->type_name("N")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000000}))
      ->capture_default_str();
  app.add_option("--range", options.range,
                 "Write the K-th of R ranges of the grid alone, as expand --ranges R cuts them. "
                 "What lies beside it, the ranges before and after it and their requests, must be "
                 "among the inputs; the rest may be")
      ->type_name("K/R")
      ->capture_default_str();
  app.add_option("--counts", options.counts,
                 "Write a line to FILE, separated by tabs: the range's number, its points that had "
                 "no level before, the records of its new frontier, and the conversions that "
                 "these ask for. It appears behind all else")
      ->type_name("FILE");
  app.add_flag("--final", options.final,
               "Write a complete grid several times smaller, for keeping and for play; nothing is "
               "lost, and every filter reads it");
  app.add_option(
         "--precision", options.precision,
         "With --final: lose precision for a still smaller grid; each component of the "
         "states, and of what is stored with them, may be off by E times the range (largest "
         "minus smallest value) that it has in the grid. Destination levels stay exact. "
         "verify and play take such a grid, expand and merge do not (1e-12 to 0.1)")
      ->type_name("E")
      ->check(number_within(1e-12, kMaxPrecision, "a share from 1e-12 to 0.1"));
  add_report(app, options.report);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  StandingOptions standing;
  bool serves = false;
  CLI::App app{
      "Merges the requests of one whole generation into a grid: finds or stores each state that\n"
      "was reached, and settles the destination levels (Algorithm 1, lines 10 to 20). Grid and\n"
      "requests come in any order and any number of shards; requests that are missing are an\n"
      "error. A grid whose frontier is empty stays as it is; one that --final made becomes\n"
      "the plain grid that it was made from, byte by byte."};
  hapgrid::describe(app, "merge");
  add_options(app, options);
  hapgrid::add_serve(app, serves);
  hapgrid::add_progress(app, standing.progress);
  hapgrid::add_model_path(app, standing.model_path);
  return hapgrid::run_tool(app, argc, argv, [&] {
    hapgrid::keep_memory();
    LoadedModel model(standing);
    const auto run_one = [&model](const Options& one) { return run(one, model); };
    if (!serves) return run_one(options);
    return hapgrid::serve("merge", add_options, run_one, [&model] { model.unload(); });
  });
}
