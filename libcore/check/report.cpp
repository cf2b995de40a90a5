#include "libcore/check/report.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <vector>

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

// Of a report that gives no more than it must, with its line on the grid.
constexpr std::size_t kMostLines = 20;

using Lines = std::vector<std::string>;

bool is_good(const Check& c) { return c.is_note || c.verdict() == "ok"; }

Lines details_of(const Check& c) {
  Lines lines{c.name + ": " + c.meaning};
  if (!c.not_proved.empty()) lines.push_back("  not proved: " + c.not_proved);
  for (const Figure& figure : c.figures)
    lines.push_back("  " + figure.name + " " + rounded(figure.value) +
                    (figure.unit.empty() ? "" : " " + printable_line(figure.unit)) +
                    (figure.where.empty() ? "" : ": " + figure.where));
  for (const Offender& offender : c.found.first) lines.push_back("  " + offender.text);
  if (c.found.offenders > c.found.first.size())
    lines.push_back("  and " + std::to_string(c.found.offenders - c.found.first.size()) + " more");
  return lines;
}

/// @param folded the rows of checks that are fine are one
Lines table_of(const std::vector<Check>& checks, bool folded) {
  using Row = std::array<std::string, 5>;
  std::vector<Row> rows{{"check", "counted", "", "offenders", "verdict"}};
  std::size_t good = 0;
  for (const Check& c : checks) {
    if (folded && is_good(c))
      ++good;
    else
      rows.push_back({c.name, std::to_string(c.found.counted), c.unit,
                      std::to_string(c.found.offenders), c.verdict()});
  }
  if (good > 0) rows.push_back({"others", std::to_string(good), "checks", "", "ok"});
  std::array<std::size_t, 5> width{};
  for (const Row& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());

  Lines lines;
  constexpr std::array kRightAligned{false, true, false, true, false};
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string gap(width[i] - row[i].size(), ' ');
      if (i > 0) line += i == 2 ? " " : "  ";
      line += kRightAligned[i] ? gap + row[i] : row[i] + gap;
    }
    lines.push_back(line.substr(0, line.find_last_not_of(' ') + 1));
  }
  return lines;
}

/// The beginnings of the details of each check, `room` lines in all; the last one says how many
/// there are beside them.
Lines shortened(const std::vector<Lines>& details, std::size_t room) {
  std::size_t all = 0;
  for (const Lines& lines : details) all += lines.size();
  Lines kept;
  const std::size_t share = std::max<std::size_t>(2, (room - 1) / details.size());
  for (const Lines& lines : details)
    for (std::size_t i = 0; i < std::min(share, lines.size()) && kept.size() + 1 < room; ++i)
      kept.push_back(lines[i]);
  kept.push_back("(" + std::to_string(all - kept.size()) + " more lines with -v)");
  return kept;
}

std::string joined(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace

std::string checks_text(const std::vector<Check>& checks, Details details) {
  std::vector<Lines> shown;
  std::size_t count = 0;
  for (const Check& c : checks) {
    const bool has_details = c.found.offenders > 0 || !c.figures.empty() || !c.not_proved.empty();
    if (!has_details || (details == Details::kNotFine && is_good(c))) continue;
    shown.push_back(details_of(c));
    count += shown.back().size() + 1;
  }
  Lines table = table_of(checks, false);
  const std::size_t room = kMostLines - 1;  // beside the line on the grid
  if (details == Details::kAll || table.size() + count <= room) {
    std::string text = joined(table);
    for (const Lines& lines : shown) text += "\n" + joined(lines);
    return text;
  }
  // At least a line of details for each check that has some.
  if (table.size() + 1 + shown.size() > room) table = table_of(checks, true);
  if (table.size() + 2 + 2 * shown.size() <= room) table.push_back("");
  return joined(table) + joined(shortened(shown, std::max(room, table.size() + 2) - table.size()));
}

std::string report_text(const ReportedGrid& grid, const std::vector<Check>& checks,
                        Details details) {
  const auto& n = grid.spec.box.counts;
  return printable_line(grid.spec.model) + ": " + std::to_string(n[0]) + " x " +
         std::to_string(n[1]) + " x " + std::to_string(n[2]) + " points, " +
         std::to_string(grid.records) + " records, generation " + std::to_string(grid.generation) +
         "\n" + checks_text(checks, details);
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

std::string report_json(const ReportedGrid& grid, const std::vector<Check>& checks) {
  nlohmann::ordered_json json;
  json["version"] = 1;
  json["model"] = grid.spec.model;
  json["counts"] = grid.spec.box.counts;
  json["records"] = grid.records;
  json["generation"] = grid.generation;
  json["verdict"] = is_broken(checks) ? "broken" : is_fine(checks) ? "fine" : "not proved";
  json["checks"] = checks_json(grid.spec.box, checks);
  // "replace": a shard's strings need not be UTF-8.
  return json.dump(2, ' ', /*ensure_ascii=*/true,
                   nlohmann::ordered_json::error_handler_t::replace) +
         "\n";
}

}  // namespace hapgrid
