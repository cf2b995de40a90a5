// stats: what is in a grid, as a report, a single value, a dump or a picture; and what happened in
// a play.

#include <charconv>
#include <cmath>
#include <istream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/input_stream.hpp"
#include "libcore/base/json_text.hpp"
#include "libcore/base/text.hpp"
#include "libcore/session/reader.hpp"
#include "libcore/shard/load.hpp"
#include "libcore/shard/section.hpp"
#include "tools/common/tool.hpp"
#include "tools/stats/arrays.hpp"
#include "tools/stats/branches.hpp"
#include "tools/stats/dump.hpp"
#include "tools/stats/gnuplot.hpp"
#include "tools/stats/motion_log.hpp"
#include "tools/stats/session.hpp"
#include "tools/stats/slice.hpp"
#include "tools/stats/statistics.hpp"
#include "tools/stats/vti.hpp"

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
  std::string npz;
  std::string vti;
  unsigned level = 0;
  std::uint32_t branch = Branches::kNone;
  std::string slice;
  std::string log;
  std::string plot;
  std::string labels;
  SessionOptions session;
  std::string png;
  std::string output = "-";
};

struct Plane {
  int axis = 2;
  double coordinate = 0;
};

/// AXIS=VALUE; nothing when it is not that.
std::optional<Plane> parse_plane(const std::string& text) {
  if (text.size() < 3 || text[0] < 'x' || text[0] > 'z' || text[1] != '=') return std::nullopt;
  Plane plane{text[0] - 'x', 0};
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data() + 2, end, plane.coordinate);
  if (read.ec != std::errc() || read.ptr != end || !std::isfinite(plane.coordinate))
    return std::nullopt;
  return plane;
}

/// A,B; nothing when there is not exactly one comma between two texts.
std::optional<std::pair<std::string, std::string>> parse_pair(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == 0 || comma >= text.size() - 1 || text.find(',', comma + 1) != text.npos)
    return std::nullopt;
  return std::pair(text.substr(0, comma), text.substr(comma + 1));
}

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

void write_picture(const std::string& name, const std::string& script) {
  OutputFile png(name);
  run_gnuplot(script, png);
  png.commit();
}

void dump(const Grid& grid, const std::string& name) {
  constexpr std::size_t kBuffer = 1 << 20;
  OutputFile output(name, /*binary=*/false);
  std::string text = dump_header(grid);
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    append_record(text, grid, r);
    if (text.size() < kBuffer) continue;
    output.write(text);
    text.clear();
  }
  output.write(text);
  output.commit();
}

/// What is drawn when column `y` is asked for. A force is drawn as the model gave it and as it was
/// sent, so that what the safety core does is not taken for a property of the model.
std::vector<std::string> columns_of(const std::string& y) {
  for (const char* axis : {"x", "y", "z"})
    if (y == std::string("force_") + axis || y == std::string("sent_") + axis)
      return {std::string("force_") + axis, std::string("sent_") + axis};
  return {y};
}

/// What a curve is called beside the other one of the same quantity.
std::string curve_name(const std::string& column) {
  if (column.starts_with("force_")) return "from the model";
  if (column.starts_with("sent_")) return "as it was sent";
  return column == "energy" ? "with the HIP" : "of the model alone";
}

/// What the axis of a log's column says: the quantity and its unit, which a grid tells of lengths
/// and energies. A state's unit is known to the model alone.
std::string column_label(const std::string& column, const GridSpec& spec) {
  const auto unit = [](const std::string& name, const char* unknown) {
    return name.empty() ? unknown : name;
  };
  if (column == "t") return axis_label("t", "s");
  if (column == "x" || column == "y" || column == "z")
    return axis_label(column + " of the HIP", unit(spec.length_unit, "model's unit of length"));
  if (column == "energy" || column == "own_energy")
    return axis_label(column == "energy" ? "energy" : "energy of the model alone",
                      unit(spec.energy_unit, "model's unit of energy"));
  for (const char axis : std::string("xyz"))
    if (column == std::string("force_") + axis || column == std::string("sent_") + axis)
      return axis_label(column.substr(column.size() - 1) + " of the force", "N");
  if (column.size() > 1 && (column[0] == 's' || column[0] == 'l') &&
      column.find_first_not_of("0123456789", 1) == column.npos)
    return column[0] == 'l' ? "level in corner " + column.substr(1)
                            : axis_label("state " + column, "model's unit");
  return column;
}

void plot_text(const InputFile& file, const Options& options) {
  if (options.plot.empty() || options.png.empty())
    throw UsageError("--log: a log that is text needs --plot and --png");
  if (!options.session.export_file.empty() || !options.npz.empty())
    throw UsageError("--export and --npz are for sessions, not text");
  const auto [x, y] = *parse_pair(options.plot);
  const GridSpec spec = options.grid == "-" ? GridSpec{} : open_grid(options.grid).header.spec;
  const auto [x_label, y_label] = options.labels.empty()
                                      ? std::pair(column_label(x, spec), column_label(y, spec))
                                      : *parse_pair(options.labels);
  InputBuffer buffer(file);
  std::istream lines(&buffer);
  std::vector<std::string> names = columns_of(y);
  // The energy against which the hand works is drawn with the part that is the model's own.
  const std::string own = "own_energy";
  const std::vector<std::vector<XY>> ticks =
      read_log(lines, file.name(), x, names, y == "energy" ? own : "");
  if (ticks.size() > names.size()) names.push_back(own);
  std::vector<MotionCurve> curves;
  for (std::size_t i = 0; i < names.size(); ++i)
    curves.push_back({curve_name(names[i]), split_motion(ticks[i])});
  // The title needs no units, which the axes have.
  const auto quantity = [](const std::string& label) { return label.substr(0, label.find(" / ")); };
  write_picture(
      options.png,
      motion_script(curves,
                    format("{} over {}, there and back", quantity(y_label), quantity(x_label)),
                    format("{}: {} ticks", file.name(), ticks[0].size()), x_label, y_label));
}

/// A session or a text, whichever the content is.
void show_log(const Options& options) {
  InputFile file(options.log, InputFile::Content::kFramesOrText);
  if (!starts_with_zstd_frame(file)) {
    plot_text(file, options);
    return;
  }
  if (!options.plot.empty())
    throw UsageError(
        "--plot draws a log that is text; the picture of a session is --png "
        "alone");
  SessionOptions session = options.session;
  session.png = options.png;
  session.npz = options.npz;
  session.format = options.format;
  session.output = options.output;
  run_session(std::move(file), session);
}

/// Refuses options that do not go together.
void check_options(const Options& options) {
  const bool reads_log = !options.log.empty();
  if (!options.get.empty() + options.dump + !options.slice.empty() + !options.vti.empty() +
          (reads_log || !options.npz.empty()) >
      1)
    throw UsageError("--get, --dump, --slice, --npz, --vti and --log exclude each other");
  if (options.branch != Branches::kNone && options.vti.empty())
    throw UsageError("--branch needs --vti");
  if (!options.slice.empty() && options.png.empty()) throw UsageError("--slice needs --png");
  if (!options.png.empty() && options.slice.empty() && !reads_log)
    throw UsageError("--png needs --slice or --log");
  if (!options.plot.empty() && !reads_log) throw UsageError("--plot needs --log");
  if (!options.labels.empty() && options.plot.empty()) throw UsageError("--labels needs --plot");
  if (!options.session.export_file.empty() && !reads_log) throw UsageError("--export needs --log");
  if (!options.get.empty()) require_known_key(options.get);
  if (reads_log && options.grid != "-" && options.plot.empty())
    throw UsageError(
        "--log reads a recorded play, so no grid can be given, except with --plot for its units");
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

void write_image(const Grid& grid, const Options& options) {
  if (options.branch == Branches::kNone)
    return write_vti(
        grid,
        [&](PointIndex p) {
          return options.level < grid.levels(p) ? grid.first(p) + options.level : Grid::kNoRecord;
        },
        options.vti);
  const Branches branches = find_branches(grid);
  const std::size_t count = branches.sizes.size();
  if (options.branch >= count)
    throw Error(format("--branch {}: this grid has {}", options.branch,
                       count == 0 ? "no branches" : format("the branches 0 to {}", count - 1)));
  write_vti(
      grid, [&](PointIndex p) { return branches.record(grid, options.branch, p); }, options.vti);
  write_all(options.output, branch_text(branches, options.branch));
}

void show_grid(const Options& options) {
  if (!options.get.empty())
    if (const auto value = value_from_footer(options.get, options.grid))
      return write_all(options.output, value_line(*value));
  const LoadedGrid loaded = load_grid(options.grid);
  if (options.dump) return dump(loaded.grid, options.output);
  if (!options.npz.empty()) return write_grid_arrays(loaded.grid, options.npz);
  if (!options.vti.empty()) return write_image(loaded.grid, options);
  if (options.slice.empty()) return write_all(options.output, report(options, loaded));
  const Plane plane = *parse_plane(options.slice);
  write_picture(options.png, slice_script(loaded.grid.spec(),
                                          slice_levels(loaded.grid, plane.axis, plane.coordinate)));
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
  app.add("--vti", options.vti,
          "Image to write for ParaView and VTK: the number of levels, and state, force and energy "
          "at --level or on --branch.")
      .type("FILE");
  app.add("--level", options.level, "Level whose state, force and energy --vti writes.")
      .type("N")
      .whole(0, kMaxLevels - 1)
      .shows_default();
  app.add("--branch", options.branch,
          "Branch, counted from 0, whose records --vti writes in place of --level.")
      .type("N")
      .whole(0, Branches::kNone - 1);
  app.add("--slice", options.slice,
          "Plane of points in which --png draws the numbers of levels, as in z=0.")
      .type("AXIS=VALUE")
      .check([](const std::string& text) { return parse_plane(text).has_value(); }, "like z=0.25");
}

void add_log_options(CommandLine& app, Options& options) {
  app.group("A log of play, instead of a grid");
  app.add("--log", options.log, "Session or text that play --log wrote ('-': standard input).")
      .type("FILE");
  app.add("--export", options.session.export_file,
          "Text to write, with a line for each tick of a session.")
      .type("FILE");
  const auto is_pair = [](const std::string& text) { return parse_pair(text).has_value(); };
  app.add("--plot", options.plot, "Columns of a text log that --png draws, Y over X.")
      .type("X,Y")
      .check(is_pair, "two texts with a comma between");
  app.add("--labels", options.labels,
          "Labels of the plot's axes (default: names of the columns, with the units of GRID).")
      .type("X,Y")
      .check(is_pair, "two texts with a comma between");
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
  app.add("--png", options.png, "Picture to write, which the program gnuplot draws.").type("FILE");
  app.add("--npz", options.npz,
          "Arrays to write for numpy: of a grid, or of a session's ticks ('-': standard output).")
      .type("FILE");
  add_output(app, options.output);
  app.set_help("stats", "hapgrid-stats(1) explains the numbers.\n");
  return run_tool(app, argc, argv, [&] { return run(options); });
}
