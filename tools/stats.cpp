// stats: what is in a grid, as a report, a single value or an array; and what happened in a play.

#include <array>
#include <cstddef>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"
#include "libcore/session/reader.hpp"
#include "libcore/shard/reader.hpp"
#include "libcore/shard/section.hpp"
#include "tools/common/inputs.hpp"
#include "tools/common/tool.hpp"
#include "tools/stats/arrays.hpp"
#include "tools/stats/session.hpp"
#include "tools/stats/statistics.hpp"

using namespace hapgrid;
using Json = nlohmann::ordered_json;

namespace {

// A line of a cost file has some 150 bytes: this is a million lines and more.
constexpr std::uint64_t kCostLimit = 256u << 20;

struct Options {
  std::string file = "-";
  std::vector<std::string> costs;
  std::string format = "text";
  std::string get;
  std::string npy;
  std::string output = "-";
};

/// What is at `key` below `json`, where '.' goes one object down or is part of a key, as in
/// "parameters.probe.radius"; nullptr when nothing is.
const Json* find(const Json& json, const std::string& key) {
  if (!json.is_object()) return nullptr;
  if (const auto whole = json.find(key); whole != json.end()) return &*whole;
  for (std::size_t dot = key.find('.'); dot != key.npos; dot = key.find('.', dot + 1))
    if (const auto head = json.find(key.substr(0, dot)); head != json.end())
      if (const Json* found = find(*head, key.substr(dot + 1))) return found;
  return nullptr;
}

/// A value that header and footer tell, so that a loop over generations need not read the whole
/// grid each time: its chunks are not looked at, and damage in them is not seen here.
std::optional<Json> value_from_footer(const std::string& key, const Section& grid) {
  if (key != "frontier" && key != "records" && key != "generation" && key != "conversions_left")
    return std::nullopt;
  if (key == "generation") return grid.header.generation;
  if (key == "frontier") return grid.frontier();
  return key == "conversions_left" ? grid.conversions() : grid.records();
}

/// A value as a line for scripts: texts without quotes, everything else as JSON.
std::string value_line(const Json& value) {
  return (value.is_string() ? printable_line(value.get<std::string>(), std::string::npos)
                            : json_line(value)) +
         "\n";
}

/// The report on the whole grid, or one value of it.
std::string report(const Options& options, const Grid& grid, std::uint64_t stored_bytes) {
  CostSums sums;
  for (const std::string& name : options.costs) {
    announce_terminal(name);
    add_costs(sums, name, read_text(name, kCostLimit));
  }
  const CostSums* costs = options.costs.empty() ? nullptr : &sums;
  const GridSpec& spec = grid.spec();
  const Statistics statistics = count_statistics(grid, stored_bytes);
  if (options.get.empty() && options.format == "text")
    return printable_text(statistics_text(spec, statistics, costs));
  const Json json = statistics_json(spec, statistics, costs);
  if (options.get.empty()) return json_text(json);
  const Json* value = find(json, options.get);
  if (!value)
    throw Error(
        format("--get: this grid has no value {}; stats --format json shows those that there are",
               options.get));
  return value_line(*value);
}

bool is_text_log(const InputFile& file) {
  std::array<std::byte, 4> start{};
  file.read(0, start);
  return std::memcmp(start.data(), "# t\t", start.size()) == 0;
}

/// Whether the scene's magic number is where frames have it.
bool is_frames(const InputFile& file) {
  std::array<char, 64> start{};
  file.read(0, std::as_writable_bytes(std::span(start)));
  return std::string_view(start.data(), start.size()).find("fdirgpah") != std::string_view::npos;
}

void show_grid(const Options& options, const Section& section) {
  if (!options.get.empty())
    if (const auto value = value_from_footer(options.get, section))
      return write_text(options.output, value_line(*value));
  const Grid grid = load_grid(section);
  if (!options.npy.empty()) return write_grid_array(grid, options.npy);
  write_text(options.output, report(options, grid, section.size()));
}

int run(const Options& options) {
  if (!options.costs.empty() && !options.get.empty() && !options.get.starts_with("costs") &&
      options.get != "cpu_hours")
    throw UsageError(format("--get: {} does not depend on --cost", options.get));
  std::vector<Input> inputs{{options.file, "input"}};
  for (const std::string& cost : options.costs) inputs.push_back({cost, "cost"});
  keep_inputs({{"--output", options.output}, {"--npy", options.npy}}, inputs);
  announce_terminal(options.file);
  InputFile file(options.file);
  if (is_text_log(file))
    throw Error(
        format("{}: a text log of play: hapgrid plot draws it; play --log FILE.session "
               "writes what stats reads",
               file.name()));
  if (is_frames(file)) {
    if (options.npy.empty())
      throw Error(
          format("{}: are frames, which view shows; --npy makes an array of them", file.name()));
    write_frames_array(SceneReader(options.file), options.npy);
    return kExitDone;
  }
  if (!is_session(file)) {
    show_grid(options, open_grid(std::make_shared<const InputFile>(std::move(file))));
    return kExitDone;
  }
  if (!options.get.empty() || !options.costs.empty())
    throw UsageError(format("{}: is a session; --get and --cost are for grids", file.name()));
  run_session(std::move(file), options.npy, options.format == "json", options.output);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Tells what is in a grid, complete or not: the row of the paper's Table 2 and more; or what "
      "happened in a play, from its session.");
  Options options;
  app.add("file", options.file,
          "Grid, or session or frames that play wrote, to read ('-' or none: standard input)")
      .type("FILE");
  app.group("A grid");
  app.add("--cost", options.costs,
          "File that expand --cost or merge --cost wrote. It can be given several times: costs are "
          "added.")
      .type("FILE")
      .repeatable();
  app.add("--get", options.get,
          "Key of the JSON report whose value alone is printed, as in --get box.spacing.")
      .type("KEY")
      .goes_with({"file", "--cost", "--output"});
  app.group("Output");
  app.add("--format", options.format, "Format of the report.")
      .one_of({"text", "json"})
      .shows_default();
  app.add("--npy", options.npy,
          "Array to write for numpy, of a grid's records, a session's ticks or the frames of play "
          "('-': standard output).")
      .type("FILE")
      .goes_with({"file"});
  add_output(app, options.output);
  app.set_help("stats", "hapgrid-stats(1) explains the numbers.\n");
  return run_tool(app, argc, argv, [&] { return run(options); });
}
