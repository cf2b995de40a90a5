#include "tools/stats/statistics.hpp"

#include <algorithm>
#include <bit>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "libcore/base/digest.hpp"
#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

using Json = nlohmann::ordered_json;

namespace {

Json ratio(double part, std::uint64_t whole) {
  return whole == 0 ? Json() : Json(part / static_cast<double>(whole));
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return "none";
  return format("{:.2f} %", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
}

std::string vector_text(const Vec3& v) { return format("({:g}, {:g}, {:g})", v[0], v[1], v[2]); }

const char* norm_name(Equality::Norm norm) {
  if (norm == Equality::Norm::kPlugin) return "plug-in";
  return norm == Equality::Norm::kMax ? "max" : "rms";
}

// A longer text is the contents of a file, of which the report has the size and the digest.
constexpr std::size_t kLongText = 65536;

Json text_json(const std::string& text) {
  if (text.size() <= kLongText) return text;
  const Digest digest = digest_of(std::as_bytes(std::span(text)));
  return {{"bytes", text.size()}, {"xxh128", format("{:016x}{:016x}", digest.high, digest.low)}};
}

Json value_json(const ParameterValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return text_json(*text);
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) {
    Json list = Json::array();
    for (const std::string& text : *texts) list.push_back(text_json(text));
    return list;
  }
  return std::visit([](const auto& v) { return Json(v); }, value);
}

double hours(const CostSums& costs) { return costs.cpu_seconds / 3600; }

// How much of a parameter the text shows.
constexpr std::size_t kLongValue = 100;

std::vector<std::string> stored_names(const GridSpec& spec) {
  std::vector<std::string> names;
  if (spec.stored.force) names.push_back("force");
  if (spec.stored.energy) names.push_back("energy");
  if (spec.stored.shape) names.push_back("shape");
  return names;
}

/// The row of the paper's Table 2, below its head, and what its numbers are.
std::string table_row(const std::string& model, const Statistics& s, const CostSums* costs) {
  const std::size_t width = std::max<std::size_t>(text_width(model), 5);
  const std::string average =
      s.points_reached == 0
          ? "-"
          : fixed(static_cast<double>(s.records) / static_cast<double>(s.points_reached), 3);
  const std::string cpu_hours = costs ? fixed(hours(*costs), hours(*costs) < 1 ? 5 : 1) : "-";
  return format(
      "{}  avg. levels  data size  CPU hours\n"
      "{}  {:>11}  {:>9}  {:>9}\n"
      "(average levels: records per point that has a level; data size: the grid as stored, in\n"
      "10^6 bytes; CPU hours: the sum of --cost)\n",
      left("model", width), left(model, width), average, megabytes(s.stored_bytes), cpu_hours);
}

}  // namespace

Statistics count_statistics(const Grid& grid, std::uint64_t stored_bytes) {
  Statistics s;
  s.points = grid.box().points();
  s.records = grid.records();
  s.generation = grid.generation();
  s.stored_bytes = stored_bytes;
  s.levels_histogram.assign(1, 0);
  for (std::uint64_t p = 0; p < s.points; ++p) {
    const RecordIndex levels = grid.levels(static_cast<PointIndex>(p));
    if (levels >= s.levels_histogram.size()) s.levels_histogram.resize(levels + 1, 0);
    ++s.levels_histogram[levels];
  }
  s.points_reached = s.points - s.levels_histogram[0];
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    s.generations = std::max(s.generations, std::uint64_t{grid.record_generation(r)} + 1);
    const auto directions =
        static_cast<std::uint64_t>(std::popcount(grid.neighbourhood().inside(grid.point(r))));
    if (grid.in_frontier(r)) ++s.frontier;
    (grid.in_frontier(r) ? s.conversions_left : s.conversions) += directions;
    for (int q = 0; q < kDirections; ++q) {
      const RecordIndex there = grid.destination(r, q);
      if (there == Grid::kNoRecord) continue;
      const RecordIndex back = grid.destination(there, Direction(q).opposite().q());
      if (back == Grid::kNoRecord) continue;
      ++s.links;
      s.one_way_links += back != r;
    }
  }
  return s;
}

void add_costs(CostSums& sums, const std::string& name, const std::string& text) {
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line(text.data() + begin, end - begin);
    begin = end + 1;
    ++number;
    const auto fail = [&](const std::string& what) {
      throw Error(format("{}: line {}: {}", name, number, what));
    };
    nlohmann::json json;
    try {
      if (!nests_too_deep(line)) json = parse_json(line);
    } catch (const nlohmann::json::exception&) {
      // It stays null.
    }
    if (!json.is_object()) fail("no JSON object");
    const auto seconds = json.find("cpu_seconds");
    if (seconds == json.end() || !seconds->is_number() || !(seconds->get<double>() >= 0))
      fail("\"cpu_seconds\" is no number of 0 or more");
    const auto count = [&](const char* key) {
      const auto value = json.find(key);
      if (value == json.end() || !value->is_number_unsigned())
        fail(format("\"{}\" is no whole number of 0 or more", key));
      return value->get<std::uint64_t>();
    };
    ++sums.lines;
    sums.cpu_seconds += seconds->get<double>();
    sums.conversions += count("conversions");
  }
}

Json statistics_json(const GridSpec& spec, const Statistics& s, const CostSums* costs) {
  Json json;
  json["version"] = 1;
  json["model"] = spec.model;
  json["parameters"] = Json::object();
  for (const Parameter& p : spec.parameters) json["parameters"][p.key] = value_json(p.value);
  json["state_size"] = spec.state_size;
  json["tolerance"] = spec.tolerance;
  json["tolerance_unit"] = spec.tolerance_unit;
  json["norm"] = norm_name(spec.equality.norm);
  json["max_levels"] = spec.max_levels;
  json["stored"] = stored_names(spec);
  json["spheres"] = spec.spheres.size();
  json["length_unit"] = spec.length_unit;
  json["energy_unit"] = spec.energy_unit;
  json["force_scale"] = spec.force_scale;
  json["box"] = {
      {"origin", spec.box.origin}, {"spacing", spec.box.spacing}, {"counts", spec.box.counts}};
  json["points"] = s.points;
  json["points_reached"] = s.points_reached;
  json["share_reached"] = ratio(static_cast<double>(s.points_reached), s.points);
  json["records"] = s.records;
  json["frontier"] = s.frontier;
  json["generation"] = s.generation;
  json["generations"] = s.generations;
  json["average_levels"] = ratio(static_cast<double>(s.records), s.points_reached);
  json["levels_histogram"] = s.levels_histogram;
  json["links"] = s.links;
  json["one_way_links"] = s.one_way_links;
  json["one_way_share"] = ratio(static_cast<double>(s.one_way_links), s.links);
  json["conversions"] = s.conversions;
  json["conversions_left"] = s.conversions_left;
  json["bytes"] = s.stored_bytes;
  json["bytes_per_record"] = ratio(static_cast<double>(s.stored_bytes), s.records);
  json["cpu_hours"] = costs ? Json(hours(*costs)) : Json();
  json["costs"] = Json();
  if (costs)
    json["costs"] = {{"lines", costs->lines},
                     {"conversions", costs->conversions},
                     {"cpu_seconds", costs->cpu_seconds}};
  return json;
}

std::string statistics_text(const GridSpec& spec, const Statistics& s, const CostSums* costs) {
  const std::string model = printable_line(spec.model);
  std::string text;
  const auto row = [&](const std::string& name, const std::string& value) {
    text += format("{}{}\n", left(name, 13), value);
  };
  row("model", model + (spec.equality.is_declared() ? ", a process" : ""));
  for (const Parameter& p : spec.parameters) {
    std::string value = json_line(value_json(p.value));
    // Contents of files.
    if (value.size() > kLongValue)
      value = format("{}... ({} bytes)", value.substr(0, kLongValue), value.size());
    row("parameter", format("{} = {}", printable_line(p.key), value));
  }
  const auto& n = spec.box.counts;
  const Vec3 last = spec.box.position(GridCoordinates{n[0] - 1, n[1] - 1, n[2] - 1});
  row("box", format("{} x {} x {} points, {:g} apart, from {} to {}", n[0], n[1], n[2],
                    spec.box.spacing, vector_text(spec.box.origin), vector_text(last)));
  row("state",
      format("{} component{}, tolerance {:g} {}", spec.state_size, spec.state_size == 1 ? "" : "s",
             spec.tolerance, printable_line(spec.tolerance_unit)));
  std::string stored;
  for (const std::string& name : stored_names(spec)) stored += (stored.empty() ? "" : ", ") + name;
  if (spec.stored.shape) stored += format(" of {} spheres", spec.spheres.size());
  if (!stored.empty()) row("stored", stored);
  if (spec.force_scale > 0 && !spec.energy_unit.empty())
    row("force",
        format("{} N on the device for 1 {} in 1 {}", rounded(spec.force_scale),
               printable_line(spec.energy_unit),
               spec.length_unit.empty() ? "unit of length" : printable_line(spec.length_unit)));
  row("points", format("{}, of these {} reached ({})", s.points, s.points_reached,
                       percent(s.points_reached, s.points)));
  row("records", format("{} in {} generations", s.records, s.generations));
  row("frontier", format("{} records{}", s.frontier,
                         s.frontier == 0 ? " (complete)" : " are still to be expanded"));
  std::string histogram;
  for (std::size_t k = 0; k < s.levels_histogram.size(); ++k)
    if (s.levels_histogram[k] > 0)
      histogram += format("{}{}: {}", histogram.empty() ? "" : ", ", k, s.levels_histogram[k]);
  row("levels",
      format("{} (levels: points that have so many; at most {})", histogram, spec.max_levels));
  row("one-way", format("{} of {} links (there and back does not return to the level)",
                        percent(s.one_way_links, s.links), s.links));
  std::string conversions = format("{} that this grid needed", s.conversions);
  if (costs) conversions += format(", {} in the cost files", costs->conversions);
  row("conversions", conversions);
  std::string size = format("{} bytes", s.stored_bytes);
  if (s.records > 0)
    size += format(", {:.2f} a record",
                   static_cast<double>(s.stored_bytes) / static_cast<double>(s.records));
  row("size", size);
  return text + "\n" + table_row(model, s, costs);
}

}  // namespace hapgrid
