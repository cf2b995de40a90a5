// stats: what is in a grid, as a report, a single value, a dump or an array; and what happened in a
// play.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/json_text.hpp"
#include "libcore/base/text.hpp"
#include "libcore/session/reader.hpp"
#include "libcore/shard/load.hpp"
#include "libcore/shard/section.hpp"
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
  std::string grid = "-";
  std::vector<std::string> costs;
  std::string format = "text";
  std::string get;
  bool dump = false;
  std::string npy;
  std::string log;
  SessionOptions session;
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

/// Refuses a key that no report has, before anything is read.
void require_known_key(const std::string& key) {
  const Json keys = statistics_json(GridSpec{}, Statistics{}, nullptr);
  if (keys.contains(key.substr(0, key.find('.')))) return;
  std::string known;
  for (const auto& item : keys.items()) known += (known.empty() ? "" : ", ") + item.key();
  throw UsageError(format("--get: no value {} (there are: {})", key, known));
}

/// A value that header and footer tell, so that a loop over generations need not read the whole
/// grid each time: its chunks are not looked at, and damage in them is not seen here.
std::optional<Json> value_from_footer(const std::string& key, const std::string& name) {
  if (key != "frontier" && key != "records" && key != "generation" && key != "conversions_left" &&
      key != "todo")
    return std::nullopt;
  const Section grid = open_grid(name);
  if (key == "generation") return grid.header.generation;
  if (key == "frontier") return grid.frontier();
  if (key == "todo") return grid.todo();
  return key == "conversions_left" ? grid.conversions() : grid.records();
}

/// A value as a line for scripts: texts without quotes, everything else as JSON.
std::string value_line(const Json& value) {
  return (value.is_string() ? printable_line(value.get<std::string>(), std::string::npos)
                            : json_line(value)) +
         "\n";
}

void write_all(const std::string& name, const std::string& text) {
  OutputFile output(name, /*binary=*/false);
  output.write(text);
  output.commit();
}

/// A line for each record: i j k level state... and the 26 destination levels, q ascending,
/// separated by tabs; '-' where the direction leaves the box, and '?' where it is not settled.
/// States have 17 significant digits, in every locale.
void dump(const Grid& grid, const std::string& name) {
  constexpr std::size_t kBuffer = 1 << 20;
  OutputFile output(name, /*binary=*/false);
  std::string text = "# i\tj\tk\tlevel";
  for (std::uint32_t c = 0; c < grid.state_size(); ++c) text += "\ts" + std::to_string(c);
  for (int q = 0; q < kDirections; ++q) text += "\td" + std::to_string(q);
  text += '\n';
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    for (const std::uint32_t c : grid.box().coordinates(grid.point(r)))
      text += std::to_string(c) + '\t';
    text += std::to_string(grid.level(r));
    for (const double value : grid.state(r)) append_digits17(text += '\t', value);
    for (const Level level : grid.links(r))
      text += '\t' + (level == kLeavesBox   ? "-"
                      : level == kUnsettled ? "?"
                                            : std::to_string(level));
    text += '\n';
    if (text.size() < kBuffer) continue;
    output.write(text);
    text.clear();
  }
  output.write(text);
  output.commit();
}

void show_log(const Options& options) {
  InputFile file(options.log, InputFile::Content::kFramesOrText);
  if (!starts_with_zstd_frame(file))
    throw Error(format("{}: not a session; hapgrid plot draws a log that is text", file.name()));
  SessionOptions session = options.session;
  session.npy = options.npy;
  session.format = options.format;
  session.output = options.output;
  run_session(std::move(file), session);
}

/// Refuses options that do not go together.
void check_options(const Options& options) {
  const bool reads_log = !options.log.empty();
  if (!options.get.empty() + options.dump + (reads_log || !options.npy.empty()) > 1)
    throw UsageError("--get, --dump, --npy and --log exclude each other");
  if (!options.session.export_file.empty() && !reads_log) throw UsageError("--export needs --log");
  if (!options.get.empty()) require_known_key(options.get);
  if (reads_log && options.grid != "-")
    throw UsageError("--log reads a recorded play, so no grid can be given");
}

/// The report on the whole grid, or one value of it.
std::string report(const Options& options, const LoadedGrid& loaded) {
  CostSums sums;
  for (const std::string& name : options.costs) {
    announce_terminal(name);
    add_costs(sums, name, read_text(name, kCostLimit));
  }
  const CostSums* costs = options.costs.empty() ? nullptr : &sums;
  const GridSpec& spec = loaded.grid.spec();
  const Statistics statistics = count_statistics(loaded.grid, loaded.stored_bytes);
  if (options.get.empty() && options.format == "text")
    return printable_text(statistics_text(spec, statistics, costs));
  const Json json = statistics_json(spec, statistics, costs);
  if (options.get.empty()) return json_text(json);
  const Json* value = find(json, options.get);
  if (!value) throw Error(format("--get: this grid has no value {}", options.get));
  return value_line(*value);
}

void show_grid(const Options& options) {
  if (!options.get.empty())
    if (const auto value = value_from_footer(options.get, options.grid))
      return write_all(options.output, value_line(*value));
  const LoadedGrid loaded = load_grid(options.grid);
  if (options.dump) return dump(loaded.grid, options.output);
  if (!options.npy.empty()) return write_grid_array(loaded.grid, options.npy);
  write_all(options.output, report(options, loaded));
}

int run(const Options& options) {
  check_options(options);
  announce_terminal(options.log.empty() ? options.grid : options.log);
  if (options.log.empty())
    show_grid(options);
  else
    show_log(options);
  return kExitDone;
}

void add_grid_options(CommandLine& app, Options& options) {
  app.group("A grid");
  app.add("--cost", options.costs,
          "File that expand --cost or merge --cost wrote. It can be given several times: costs are "
          "added.")
      .type("FILE")
      .repeatable();
  app.add("--get", options.get,
          "Key of the JSON report whose value alone is printed, as in --get box.spacing.")
      .type("KEY");
  app.add_flag("--dump", options.dump,
               "Print a line for each record: i j k level state..., and the levels of 26 links.");
}

void add_log_options(CommandLine& app, Options& options) {
  app.group("A log of play, instead of a grid");
  app.add("--log", options.log, "Session that play --log wrote ('-': standard input).")
      .type("FILE");
  app.add("--export", options.session.export_file,
          "Text to write, with a line for each tick of a session.")
      .type("FILE");
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Tells what is in a grid, complete or not: the row of the paper's Table 2 and more. With "
      "--log it tells what happened in a play.");
  Options options;
  add_grid(app, options.grid);
  add_grid_options(app, options);
  add_log_options(app, options);
  app.group("Output");
  app.add("--format", options.format, "Format of the report.")
      .one_of({"text", "json"})
      .shows_default();
  app.add("--npy", options.npy,
          "Array to write for numpy, of a grid's records or a session's ticks ('-': standard "
          "output).")
      .type("FILE");
  add_output(app, options.output);
  app.set_help("stats", "hapgrid-stats(1) explains the numbers.\n");
  return run_tool(app, argc, argv, [&] { return run(options); });
}
