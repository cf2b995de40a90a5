#include "libcore/check/report.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "libcore/base/text.hpp"

namespace hapgrid {

bool is_fine(const std::vector<Check>& checks) {
  return std::none_of(checks.begin(), checks.end(), [](const Check& c) {
    return !c.is_note && (c.found.offenders > 0 || !c.not_proved.empty());
  });
}

bool is_broken(const std::vector<Check>& checks) {
  return std::any_of(checks.begin(), checks.end(),
                     [](const Check& c) { return !c.is_note && c.found.offenders > 0; });
}

std::string verdict_line(const std::vector<Check>& checks) {
  std::string broken, open;
  std::size_t passed = 0;
  const auto add = [](std::string& list, const std::string& entry) {
    list += (list.empty() ? "" : ", ") + entry;
  };
  for (const Check& c : checks) {
    if (c.is_note) continue;
    if (c.found.offenders > 0)
      add(broken, c.name + " (" + std::to_string(c.found.offenders) + " of " +
                      std::to_string(c.found.counted) + ")");
    else if (!c.not_proved.empty())
      add(open, c.name);
    else
      ++passed;
  }
  if (broken.empty() && open.empty()) return "fine: " + std::to_string(passed) + " checks";
  if (broken.empty()) return "not proved: " + open;
  return "broken: " + broken + (open.empty() ? "" : "; not proved: " + open);
}

namespace {

std::string details_text(const Check& c) {
  std::string text = "\n" + c.name + ": " + c.meaning + "\n";
  if (!c.not_proved.empty()) text += "  not proved: " + c.not_proved + "\n";
  for (const Figure& figure : c.figures)
    text += "  " + figure.name + " " + rounded(figure.value) +
            (figure.unit.empty() ? "" : " " + printable_line(figure.unit)) +
            (figure.where.empty() ? "" : ": " + figure.where) + "\n";
  for (const Offender& offender : c.found.first) text += "  " + offender.text + "\n";
  if (c.found.offenders > c.found.first.size())
    text += "  and " + std::to_string(c.found.offenders - c.found.first.size()) + " more\n";
  return text;
}

}  // namespace

std::string checks_text(const std::vector<Check>& checks, Details details) {
  using Row = std::array<std::string, 5>;
  std::vector<Row> rows{{"check", "counted", "", "offenders", "verdict"}};
  for (const Check& c : checks)
    rows.push_back({c.name, std::to_string(c.found.counted), c.unit,
                    std::to_string(c.found.offenders), c.verdict()});
  std::array<std::size_t, 5> width{};
  for (const Row& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());

  std::string text;
  constexpr std::array kRightAligned{false, true, false, true, false};
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string gap(width[i] - row[i].size(), ' ');
      if (i > 0) line += i == 2 ? " " : "  ";
      line += kRightAligned[i] ? gap + row[i] : row[i] + gap;
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  for (const Check& c : checks) {
    const bool has_details = c.found.offenders > 0 || !c.figures.empty() || !c.not_proved.empty();
    const bool is_fine = c.is_note || c.verdict() == "ok";
    if (has_details && (details == Details::kAll || !is_fine)) text += details_text(c);
  }
  return text;
}

std::string report_text(const Grid& grid, const std::vector<Check>& checks, Details details) {
  const auto& n = grid.box().counts;
  return printable_line(grid.spec().model) + ": " + std::to_string(n[0]) + " x " +
         std::to_string(n[1]) + " x " + std::to_string(n[2]) + " points, " +
         std::to_string(grid.records()) + " records, generation " +
         std::to_string(grid.generation()) + "\n" + checks_text(checks, details);
}

namespace {

nlohmann::ordered_json offender_json(const Box& box, const Offender& offender) {
  nlohmann::ordered_json json{{"text", offender.text}};
  const Place& place = offender.place;
  if (place.point) json["point"] = box.coordinates(*place.point);
  if (place.level) json["level"] = *place.level;
  if (place.direction) json["direction"] = Direction(*place.direction).step();
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
  // "replace": a shard's strings need not be UTF-8.
  return json.dump(2, ' ', /*ensure_ascii=*/true,
                   nlohmann::ordered_json::error_handler_t::replace) +
         "\n";
}

}  // namespace hapgrid
