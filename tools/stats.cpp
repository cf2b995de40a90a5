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
#include "libcore/base/input_stream.hpp"
#include "libcore/check/dump.hpp"
#include "libcore/check/motion_log.hpp"
#include "libcore/check/slice.hpp"
#include "libcore/check/statistics.hpp"
#include "libcore/check/text.hpp"
#include "libcore/session/reader.hpp"
#include "libcore/shard/load.hpp"
#include "libcore/shard/section.hpp"
#include "tools/common/gnuplot.hpp"
#include "tools/common/tool.hpp"
#include "tools/stats/session.hpp"

using namespace hapgrid;
using Json = nlohmann::ordered_json;

namespace {

// A line of a report is some 150 bytes: this is a million lines and more.
constexpr std::uint64_t kReportLimit = 256u << 20;

struct Options {
  std::string grid = "-";
  std::vector<std::string> reports;
  std::string format = "text";
  std::string get;
  bool dump = false;
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
  throw CLI::ValidationError("--get: no value " + key + " (there are: " + known + ")");
}

/// A value that header and footer tell, so that a loop over generations need not read the whole
/// grid each time: its chunks are not looked at, and damage in them is not seen here.
std::optional<Json> value_from_footer(const std::string& key, const std::string& name) {
  if (key != "frontier" && key != "records" && key != "generation" && key != "conversions_left")
    return std::nullopt;
  const Section grid = open_grid(name);
  if (key == "generation") return grid.header.generation;
  if (key == "frontier") return grid.frontier();
  return key == "conversions_left" ? grid.conversions() : grid.records();
}

/// A value as a line for scripts: texts without quotes, everything else as JSON. "replace": a
/// shard's strings need not be UTF-8.
std::string value_line(const Json& value) {
  return (value.is_string() ? printable(value.get<std::string>())
                            : value.dump(-1, ' ', false, Json::error_handler_t::replace)) +
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
  std::string text;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    append_record(text, grid, r);
    if (text.size() < kBuffer) continue;
    output.write(text);
    text.clear();
  }
  output.write(text);
  output.commit();
}

/// Whether anything is asked for that only a session has.
bool asks_for_session(const SessionOptions& options) {
  return std::isfinite(options.from) || std::isfinite(options.to) || options.salvage ||
         !options.export_file.empty();
}

void plot_text(const InputFile& file, const Options& options) {
  if (options.plot.empty() || options.png.empty())
    throw CLI::ValidationError("--log: a log that is text needs --plot and --png");
  if (asks_for_session(options.session))
    throw CLI::ValidationError("--from, --to, --export and --salvage are for sessions, not text");
  const auto [x, y] = *parse_pair(options.plot);
  const auto [x_label, y_label] =
      *parse_pair(options.labels.empty() ? options.plot : options.labels);
  InputBuffer buffer(file);
  std::istream lines(&buffer);
  const std::vector<XY> ticks = read_log(lines, file.name(), x, y);
  write_picture(
      options.png,
      motion_script(split_motion(ticks), y_label + " over " + x_label + ", there and back",
                    file.name() + ": " + std::to_string(ticks.size()) + " ticks", x_label,
                    y_label));
}

/// A session or a text, whichever the content is.
void show_log(const Options& options) {
  InputFile file(options.log);
  if (!starts_with_zstd_frame(file)) {
    plot_text(file, options);
    return;
  }
  if (!options.plot.empty())
    throw CLI::ValidationError(
        "--plot draws a log that is text; the picture of a session is --png "
        "alone");
  SessionOptions session = options.session;
  session.png = options.png;
  session.format = options.format;
  session.output = options.output;
  run_session(std::move(file), session);
}

int run(const Options& options) {
  const bool reads_log = !options.log.empty();
  if (!options.get.empty() + options.dump + !options.slice.empty() + reads_log > 1)
    throw CLI::ValidationError("--get, --dump, --slice and --log exclude each other");
  if (!options.slice.empty() && options.png.empty())
    throw CLI::ValidationError("--slice needs --png");
  if (!options.png.empty() && options.slice.empty() && !reads_log)
    throw CLI::ValidationError("--png needs --slice or --log");
  if (!options.plot.empty() && !reads_log) throw CLI::ValidationError("--plot needs --log");
  if (!options.labels.empty() && options.plot.empty())
    throw CLI::ValidationError("--labels needs --plot");
  if (asks_for_session(options.session) && !reads_log)
    throw CLI::ValidationError("--from, --to, --export and --salvage need --log");
  if (!options.get.empty()) require_known_key(options.get);
  if (reads_log) {
    if (options.grid != "-")
      throw CLI::ValidationError("--log tells of a play and reads no shard");
    show_log(options);
    return kExitDone;
  }
  if (!options.get.empty())
    if (const auto value = value_from_footer(options.get, options.grid)) {
      write_all(options.output, value_line(*value));
      return kExitDone;
    }
  ReportSums sums;
  for (const std::string& name : options.reports)
    add_reports(sums, name, read_text(name, kReportLimit));
  const ReportSums* reports = options.reports.empty() ? nullptr : &sums;

  const LoadedGrid loaded = load_grid(options.grid);
  const GridSpec& spec = loaded.grid.spec();
  if (options.dump) {
    dump(loaded.grid, options.output);
    return kExitDone;
  }
  if (!options.slice.empty()) {
    const Plane plane = *parse_plane(options.slice);
    write_picture(options.png,
                  slice_script(spec, slice_levels(loaded.grid, plane.axis, plane.coordinate)));
    return kExitDone;
  }
  Statistics statistics = count_statistics(loaded.grid, loaded.stored_bytes);
  if (options.get.empty() && options.format == "text") {
    write_all(options.output, statistics_text(spec, statistics, reports));
    return kExitDone;
  }
  const Json json = statistics_json(spec, statistics, reports);
  if (options.get.empty()) {
    // "replace": a shard's strings need not be UTF-8.
    write_all(options.output, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
    return kExitDone;
  }
  const Json* value = find(json, options.get);
  if (!value) throw Error("--get: this grid has no value " + options.get);
  write_all(options.output, value_line(*value));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Tells what is in a grid, complete or not: the row of the paper's Table 2 and more; with "
      "--log,\n"
      "what happened in a play.");
  Options options;
  add_grid(app, options.grid);
  app.add_option("--reports", options.reports,
                 "JSON lines that expand --cost and merge --cost wrote; their CPU seconds and "
                 "conversions are added up. Takes all names up to the next option or '--'")
      ->type_name("FILE");
  app.add_option("--format", options.format, "How the report is written")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  app.add_option(
         "--get", options.get,
         "Print this value of the JSON report alone, as in --get average_levels, --get "
         "box.spacing; frontier, conversions_left, records and generation are read from the "
         "footer at once, without a look at the records")
      ->type_name("KEY");
  app.add_flag("--dump", options.dump,
               "Print a record a line, separated by tabs: i j k level state... and 26 destination "
               "levels, '-' where a direction leaves the box, '?' where it is not settled");
  app.add_option("--slice", options.slice,
                 "Draw how many levels the points have in the grid plane nearest to x, y or z = "
                 "VALUE (model's unit of length), as in --slice z=0")
      ->type_name("AXIS=VALUE")
      ->check([](const std::string& text) {
        return parse_plane(text) ? "" : "'" + text + "' is not like z=0.25";
      });
  app.add_option(
         "--log", options.log,
         "Instead of reading a grid, read what play --log wrote ('-': standard input). Of a "
         "session: print a report, or draw it (--png), or write it as text (--export); of a "
         "text: draw two columns (--plot and --png)")
      ->type_name("FILE");
  const auto is_finite = CLI::Validator(
      [](const std::string& text) {
        double value = std::nan("");
        return CLI::detail::lexical_cast(text, value) && std::isfinite(value)
                   ? std::string()
                   : "'" + text + "' is not a number of seconds";
      },
      "");
  app.add_option("--from", options.session.from, "Only a session's ticks from this time on")
      ->type_name("SECONDS")
      ->check(is_finite);
  app.add_option("--to", options.session.to, "Only a session's ticks before this time")
      ->type_name("SECONDS")
      ->check(is_finite);
  app.add_option(
         "--export", options.session.export_file,
         "Write a session's ticks as text ('-': standard output), a line each, separated by "
         "tabs")
      ->type_name("FILE");
  app.add_flag("--salvage", options.session.salvage,
               "Take what can be read of a session that was interrupted (FILE.part) or is damaged; "
               "the report says how much is lost");
  const auto is_pair = [](const std::string& text) {
    return parse_pair(text) ? "" : "'" + text + "' is not two texts with a comma between";
  };
  app.add_option("--plot", options.plot,
                 "Two columns of the log by their names: the second over the first, coloured by "
                 "where the first is going, as in --plot x,s0")
      ->type_name("X,Y")
      ->check(is_pair);
  app.add_option("--labels", options.labels,
                 "Labels of the plot's two axes (default: the columns' names)")
      ->type_name("X,Y")
      ->check(is_pair);
  app.add_option("--png", options.png, "Where the picture goes; gnuplot draws it")
      ->type_name("FILE");
  add_output(app, options.output);
  describe(
      app, "stats",
      "What the numbers mean (null or '-' where there is nothing to divide by):\n"
      "  norm                how the tolerance is applied: max or rms of the components'\n"
      "                      differences; plug-in: its own function\n"
      "  average_levels      records per point that has a level\n"
      "  share_reached       points that have a level, of all points\n"
      "  levels_histogram    entry k: points that have k levels, k = 0, 1, ...\n"
      "  irreversible_share  of the links that can be followed there and back, those that do\n"
      "                      not come back to the level they started from\n"
      "  conversions         evaluations of C that the grid needed: in-box directions of all\n"
      "                      records but the frontier's\n"
      "  conversions_left    those that the frontier asks for\n"
      "  bytes               size of the grid as stored (compressed)\n"
      "  cpu_hours           CPU seconds of --reports / 3600\n"
      "\n"
      "In the report of a session:\n"
      "  missed              numbers of ticks between the first and the last one that are not\n"
      "                      there; JSON: null if the disk was too slow for others of them\n"
      "  dropped             ticks of the whole session that the disk was too slow for\n"
      "  largest_force       of the magnitudes, in newtons, as sent; raw: before the safety core\n"
      "  force_not_computed  ticks without a raw force\n"
      "  flags               ticks in which each flag was set\n"
      "  lateness_us         from when a tick was due to when it started, in microseconds;\n"
      "                      percentiles are at most 1 % too high, the maximum is exact\n"
      "  compute_us          from a tick's start until its force was sent\n");
  return run_tool(app, argc, argv, [&] { return run(options); });
}
