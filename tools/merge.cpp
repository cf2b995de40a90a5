// merge: a generation's requests into the grid.

#include "libcore/search/merge.hpp"

#include <algorithm>

#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "tools/common/inputs.hpp"
#include "tools/common/models.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/tool.hpp"

namespace {

using namespace hapgrid;

struct Options {
  std::vector<std::string> shards;
  std::string output = "-";
  bool small = false;
  std::string cost;
};

/// A finished grid, stored small. Answers its generation.
std::uint32_t write_small(const std::string& name, const std::string& output) {
  const Section grid = open_grid(name);
  OutputFile out(output);
  SectionWriter writer(out.fd(), out.name(), grid.header, Packing::kSmall);
  copy_finished(grid, writer);
  out.commit();
  return grid.header.generation;
}

std::uint32_t write_merged(const std::vector<std::string>& names, const Options& options) {
  allow_open_files(names.size());
  std::vector<Section> requests = open_sections(names);
  const Section grid = take_grid(requests);
  for (const std::string& name : names)  // the grid may be replaced by the merged one
    if ((name == "-" ? "standard input" : name) != grid.file->name())
      keep_inputs({{"--output", options.output}}, {{name, "requests"}});
  const auto model = judging_model(grid.header.spec);
  const SectionHeader header = merged_header(grid);
  OutputFile out(options.output);
  Progress progress;
  {
    const double all = static_cast<double>(grid.conversions());
    const ProgressLine line([&](double seconds) {
      const double done = static_cast<double>(progress.conversions);
      const double rate = done / std::max(seconds, 1e-3);
      return format("merge: {}, generation {}, {} of {} requests, {}/s",
                    part_done(done / std::max(all, 1.0), rate / std::max(all, 1.0)),
                    header.generation, short_number(done), short_number(all), short_number(rate));
    });
    merge(grid, requests, *model, out.fd(), out.name(), progress);
  }
  out.commit();
  return header.generation;
}

int run(const Options& options) {
  std::vector<std::string> names = options.shards;
  if (names.empty()) names.push_back("-");
  if (std::count(names.begin(), names.end(), "-") > 1)
    throw UsageError("standard input can be read only once");
  for (const std::string& name : names) announce_terminal(name);
  if (options.small && names.size() > 1) throw UsageError("--small: takes one grid");
  for (const std::string& name : names) keep_inputs({{"--cost", options.cost}}, {{name, "input"}});
  const std::uint32_t generation =
      options.small ? write_small(names.front(), options.output) : write_merged(names, options);
  RunCost cost;
  cost.tool = "merge";
  cost.generation = generation;
  if (!options.cost.empty()) append_cost(options.cost, cost);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CommandLine app{
      "Merges the requests of one whole generation into a grid: finds or stores each state that\n"
      "was reached, and settles the destination levels (Algorithm 1, lines 10 to 20). The grid\n"
      "and the requests come in any order and any number of shards; requests that are missing\n"
      "are an error. A grid without frontier stays as it is. The whole grid is held in memory."};
  app.set_help("merge");
  app.add("shard", options.shards,
          "The grid and all requests of its frontier ('-' or none: standard input)")
      .type("SHARD");
  add_output(app, options.output);
  app.add_flag("--small", options.small,
               "Write a finished grid in large chunks at a high zstd level, for keeping and for "
               "play; nothing is lost, and every tool reads it")
      .goes_with({"shard", "--output", "--cost"});
  add_cost(app, options.cost);
  return run_tool(app, argc, argv, [&] {
    keep_memory();
    return run(options);
  });
}
