#include "libcore/check/report.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

bool is_good(const Check& c) { return c.is_note || c.verdict() == "ok"; }

/// The columns of the table.
std::string table_of(const std::vector<Check>& checks) {
  using Row = std::array<std::string, 5>;
  std::vector<Row> rows{{"check", "counted", "", "offenders", "verdict"}};
  for (const Check& c : checks)
    rows.push_back({c.name, std::to_string(c.found.counted), c.unit,
                    std::to_string(c.found.offenders), c.verdict()});
  std::array<std::size_t, 4> width{};
  for (const Row& row : rows)
    for (std::size_t i = 0; i < width.size(); ++i)
      width[i] = std::max(width[i], text_width(row[i]));
  std::string text;
  for (const Row& row : rows)
    text += format("{}  {} {}  {}  {}\n", left(row[0], width[0]), right(row[1], width[1]),
                   left(row[2], width[2]), right(row[3], width[3]), row[4]);
  return text;
}

/// What there is to say of a check below the table, with a line for what an offender is.
std::string details_of(const Check& c) {
  std::string text =
      format("{}: {}{}\n", c.name, c.verdict() == "ok" ? "none found: " : "", c.meaning);
  if (!c.not_proved.empty()) text += format("  not proved: {}\n", c.not_proved);
  for (const Figure& figure : c.figures)
    text += format("  {} {}{}{}\n", figure.name, rounded(figure.value),
                   figure.unit.empty() ? "" : format(" {}", printable_line(figure.unit)),
                   figure.where.empty() ? "" : format(": {}", figure.where));
  for (const Offender& offender : c.found.first) text += format("  {}\n", offender.text);
  if (c.found.offenders > c.found.first.size())
    text += format("  and {} more\n", c.found.offenders - c.found.first.size());
  return text;
}

}  // namespace

bool is_fine(const std::vector<Check>& checks) {
  return std::all_of(checks.begin(), checks.end(), is_good);
}

bool is_broken(const std::vector<Check>& checks) {
  return std::any_of(checks.begin(), checks.end(),
                     [](const Check& c) { return c.verdict() == "broken"; });
}

std::string verdict_line(const std::vector<Check>& checks) {
  std::string broken, open, remarks;
  std::size_t passed = 0;
  for (const Check& c : checks) {
    if (c.verdict() == "ok") ++passed;
    if (!c.remark.empty()) remarks += (remarks.empty() ? ", but " : "; ") + c.remark;
    if (c.verdict() == "broken")
      broken += format("{}{} ({} of {})", broken.empty() ? "" : ", ", c.name, c.found.offenders,
                       c.found.counted);
    if (c.verdict() == "not proved") open += (open.empty() ? "" : ", ") + c.name;
  }
  if (broken.empty() && open.empty()) return format("fine: {} checks{}", passed, remarks);
  if (broken.empty()) return "not proved: " + open + remarks;
  return "broken: " + broken + (open.empty() ? "" : "; not proved: " + open);
}

std::string checks_text(const std::vector<Check>& checks, bool all) {
  std::string text = table_of(checks);
  for (const Check& c : checks) {
    const bool has_details = c.found.offenders > 0 || !c.figures.empty() || !c.not_proved.empty();
    if (has_details && (all || !is_good(c))) text += format("\n{}", details_of(c));
  }
  return text;
}

std::string report_text(const Grid& grid, const std::vector<Check>& checks, bool all) {
  const auto& n = grid.box().counts;
  return format("{}: {} x {} x {} points, {} records, generation {}\n{}",
                printable_line(grid.spec().model), n[0], n[1], n[2], grid.records(),
                grid.generation(), checks_text(checks, all));
}

namespace {

nlohmann::ordered_json offender_json(const Box& box, const Offender& offender) {
  nlohmann::ordered_json json{{"text", offender.text}};
  if (offender.point) json["point"] = box.coordinates(*offender.point);
  if (offender.level) json["level"] = *offender.level;
  if (offender.direction) json["direction"] = Direction(*offender.direction).step();
  return json;
}

}  // namespace

nlohmann::ordered_json checks_json(const Box& box, const std::vector<Check>& checks) {
  auto json = nlohmann::ordered_json::array();
  for (const Check& c : checks) {
    nlohmann::ordered_json row;
    row["name"] = c.name;
    row["verdict"] = c.verdict();
    row["counted"] = c.found.counted;
    row["unit"] = c.unit;
    row["offenders"] = c.found.offenders;
    row["meaning"] = c.meaning;
    row["first"] = nlohmann::ordered_json::array();
    for (const Offender& offender : c.found.first)
      row["first"].push_back(offender_json(box, offender));
    if (!c.not_proved.empty()) row["not_proved"] = c.not_proved;
    row["figures"] = nlohmann::ordered_json::array();
    for (const Figure& f : c.figures)
      row["figures"].push_back(
          {{"name", f.name}, {"value", f.value}, {"unit", f.unit}, {"where", f.where}});
    json.push_back(std::move(row));
  }
  return json;
}

std::string report_json(const Grid& grid, const std::vector<Check>& checks) {
  nlohmann::ordered_json json;
  json["version"] = 1;
  json["model"] = grid.spec().model;
  json["counts"] = grid.box().counts;
  json["records"] = grid.records();
  json["generation"] = grid.generation();
  json["verdict"] = is_broken(checks) ? "broken" : is_fine(checks) ? "fine" : "not proved";
  json["checks"] = checks_json(grid.box(), checks);
  return json_text(json);
}

}  // namespace hapgrid
