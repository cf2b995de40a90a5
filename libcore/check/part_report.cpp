#include "libcore/check/part_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormatKey = "hapgrid verify part";
constexpr int kFormat = 1;

// Texts of shards and models need not be UTF-8, as JSON's are: each byte is a character (Latin-1).
Json text_to_json(const std::string& bytes) {
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      text += c;
    } else {
      text += static_cast<char>(0xc0 | byte >> 6);
      text += static_cast<char>(0x80 | (byte & 0x3f));
    }
  }
  return text;
}

std::string text_from_json(const Json& json) {
  const auto& text = json.get_ref<const std::string&>();
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x80) {
      bytes += text[i];
    } else {
      if (byte > 0xc3 || ++i == text.size()) throw Error("a text that is none of ours");
      bytes += static_cast<char>((byte & 3) << 6 | (static_cast<unsigned char>(text[i]) & 0x3f));
    }
  }
  return bytes;
}

// JSON has no infinity, and "not a number" only as null.
Json number_to_json(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

double number_from_json(const Json& json) {
  if (json.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (!json.is_string()) return json.get<double>();
  if (json == "inf") return std::numeric_limits<double>::infinity();
  if (json == "-inf") return -std::numeric_limits<double>::infinity();
  throw Error("a number that is none");
}

/// The library would take -1 and 1e300 too, and make any number of them.
std::uint64_t count_from_json(const Json& json) {
  if (!json.is_number_unsigned()) throw Error("a count that is none");
  return json.get<std::uint64_t>();
}

std::uint32_t small_count_from_json(const Json& json) {
  const std::uint64_t count = count_from_json(json);
  if (count > std::numeric_limits<std::uint32_t>::max()) throw Error("a count that is none");
  return static_cast<std::uint32_t>(count);
}

GridCoordinates counts_from_json(const Json& json) {
  return {small_count_from_json(json.at(0)), small_count_from_json(json.at(1)),
          small_count_from_json(json.at(2))};
}

Json to_json(const Findings& found) {
  Json first = Json::array();
  for (const std::string& text : found.first) first.push_back(text_to_json(text));
  return {{"counted", found.counted}, {"offenders", found.offenders}, {"first", first}};
}

Findings findings_from(const Json& json) {
  Findings found{count_from_json(json.at("counted")), count_from_json(json.at("offenders")), {}};
  for (const Json& text : json.at("first")) found.first.push_back(text_from_json(text));
  return found;
}

Json to_json(const Check& check) {
  Json figures = Json::array();
  for (const Figure& f : check.figures)
    figures.push_back({{"name", text_to_json(f.name)},
                       {"value", number_to_json(f.value)},
                       {"unit", text_to_json(f.unit)},
                       {"where", text_to_json(f.where)}});
  return {{"name", text_to_json(check.name)},       {"unit", text_to_json(check.unit)},
          {"meaning", text_to_json(check.meaning)}, {"note", check.is_note},
          {"found", to_json(check.found)},          {"figures", figures}};
}

Check check_from(const Json& json) {
  Check check{text_from_json(json.at("name")), text_from_json(json.at("unit")),
              text_from_json(json.at("meaning")), findings_from(json.at("found")), json.at("note")};
  for (const Json& f : json.at("figures"))
    check.figures.push_back({text_from_json(f.at("name")), number_from_json(f.at("value")),
                             text_from_json(f.at("unit")), text_from_json(f.at("where"))});
  return check;
}

Json to_json(const AccuracyTerms& terms) {
  return {{"wanted", terms.wanted ? number_to_json(*terms.wanted) : Json()},
          {"spacing", number_to_json(terms.spacing)},
          {"counts", terms.counts},
          {"state_unit", text_to_json(terms.state_unit)},
          {"length_unit", text_to_json(terms.length_unit)},
          {"has_force", terms.has_force}};
}

AccuracyTerms terms_from(const Json& json) {
  AccuracyTerms terms;
  if (!json.at("wanted").is_null()) terms.wanted = number_from_json(json.at("wanted"));
  terms.spacing = number_from_json(json.at("spacing"));
  terms.counts = counts_from_json(json.at("counts"));
  terms.state_unit = text_from_json(json.at("state_unit"));
  terms.length_unit = text_from_json(json.at("length_unit"));
  terms.has_force = json.at("has_force");
  return terms;
}

Json to_json(const WorstError& worst) {
  return {{"value", number_to_json(worst.value)}, {"where", text_to_json(worst.where)}};
}

WorstError worst_from(const Json& json) {
  return {number_from_json(json.at("value")), text_from_json(json.at("where"))};
}

Json to_json(const Walked& walked) {
  Json errors = Json::array();
  for (const PlayError& e : walked.one_branch)
    for (const double value : {e.state, e.force, e.coarse_state, e.coarse_force})
      errors.push_back(number_to_json(value));
  return {{"places", walked.places},
          {"empty", walked.empty},
          {"mixed", walked.mixed},
          {"parted", walked.parted},
          {"state", to_json(walked.state)},
          {"force", to_json(walked.force)},
          {"mixed_state", to_json(walked.mixed_state)},
          {"failed", to_json(walked.failed)},
          {"errors", errors}};
}

Walked walked_from(const Json& json) {
  Walked walked;
  walked.places = count_from_json(json.at("places"));
  walked.empty = count_from_json(json.at("empty"));
  walked.mixed = count_from_json(json.at("mixed"));
  walked.parted = count_from_json(json.at("parted"));
  walked.state = worst_from(json.at("state"));
  walked.force = worst_from(json.at("force"));
  walked.mixed_state = worst_from(json.at("mixed_state"));
  walked.failed = findings_from(json.at("failed"));
  const Json& errors = json.at("errors");
  for (std::size_t i = 0; i < errors.size(); i += 4) {
    const PlayError e{number_from_json(errors.at(i)), number_from_json(errors.at(i + 1)),
                      number_from_json(errors.at(i + 2)), number_from_json(errors.at(i + 3))};
    // They are going to be sorted. With twice the spacing there may be none.
    if (std::isnan(e.state) || std::isnan(e.force) ||
        std::isnan(e.coarse_state) != std::isnan(e.coarse_force))
      throw Error("a place without its error");
    walked.one_branch.push_back(e);
  }
  return walked;
}

std::string ordinal(const CheckPart& part) {
  return "part " + std::to_string(part.number) + " of " + std::to_string(part.of);
}

/// What makes two parts none of the same whole, empty when nothing does.
std::string foreign(const PartReport& part, const PartReport& first) {
  if (part.digest != first.digest || part.grid != first.grid)
    return "of another grid (" + printable_line(part.digest) + ", not " +
           printable_line(first.digest) + ")";
  if (part.part.of != first.part.of)
    return ordinal(part.part) + ", not of " + std::to_string(first.part.of);
  for (const auto& [key, value] : first.options.items())
    if (!part.options.contains(key) || part.options.at(key) != value)
      return "made with another " + printable_line(key) + " (" +
             (part.options.contains(key) ? printable_line(part.options.at(key).dump()) : "none") +
             ", not " + printable_line(value.dump()) + ")";
  return part.options.size() == first.options.size() ? "" : "made with other options";
}

}  // namespace

std::vector<Check> join(std::vector<PartReport> parts, const std::vector<std::string>& names) {
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::string what = foreign(parts[i], parts[0]);
    if (!what.empty()) throw Error(names[i] + ": it is " + what + ", as " + names[0] + " is");
  }
  std::vector<std::size_t> order(parts.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return parts[a].part.number < parts[b].part.number;
  });
  CheckPart wanted{1, parts.at(0).part.of};
  for (std::size_t i = 0; i < order.size(); ++i, ++wanted.number) {
    const std::uint64_t number = parts[order[i]].part.number;
    if (number < wanted.number)
      throw Error(names[order[i]] + ": " + ordinal(parts[order[i]].part) + ", as " +
                  names[order[i - 1]] + " is");
    if (number > wanted.number) throw Error(ordinal(wanted) + " is missing");
  }
  if (wanted.number <= wanted.of) throw Error(ordinal(wanted) + " is missing");

  PartReport& first = parts[order[0]];
  std::vector<Check> checks = std::move(first.checks);
  Walked walked = std::move(first.walked);
  for (std::size_t i = 1; i < order.size(); ++i) {
    PartReport& part = parts[order[i]];
    for (Check& more : part.checks) {
      const auto row = std::find_if(checks.begin(), checks.end(),
                                    [&](const Check& c) { return c.name == more.name; });
      if (row == checks.end())
        throw Error(names[order[i]] +
                    ": a check that the first part has not: " + printable_line(more.name));
      row->found.add(std::move(more.found));
    }
    walked.add(std::move(part.walked));
  }
  if (first.terms) checks.push_back(check_accurate(walked, *first.terms));
  return checks;
}

std::string part_to_json(const PartReport& part) {
  Json json;
  json[kFormatKey] = kFormat;
  json["part"] = part.part.number;
  json["of"] = part.part.of;
  json["grid"] = {{"digest", part.digest},
                  {"model", text_to_json(part.grid.model)},
                  {"counts", part.grid.counts},
                  {"records", part.grid.records},
                  {"generation", part.grid.generation}};
  json["options"] = part.options;
  json["checks"] = Json::array();
  for (const Check& check : part.checks) json["checks"].push_back(to_json(check));
  if (part.terms)
    json["walks"] = {{"terms", to_json(*part.terms)}, {"found", to_json(part.walked)}};
  return json.dump() + "\n";
}

PartReport part_from_json(const std::string& text, const std::string& name) {
  try {
    const Json json = Json::parse(text);
    if (!json.is_object() || !json.contains(kFormatKey)) throw Error("no report of verify --part");
    if (json.at(kFormatKey) != kFormat)
      throw Error("format " + printable_line(json.at(kFormatKey).dump()) +
                  " of verify --part, not " + std::to_string(kFormat));
    PartReport part;
    part.part = {count_from_json(json.at("part")), count_from_json(json.at("of"))};
    if (part.part.number < 1 || part.part.number > part.part.of)
      throw Error(ordinal(part.part) + " cannot be");
    const Json& grid = json.at("grid");
    part.digest = grid.at("digest");
    part.grid = {text_from_json(grid.at("model")), counts_from_json(grid.at("counts")),
                 count_from_json(grid.at("records")), small_count_from_json(grid.at("generation"))};
    part.options = json.at("options");
    for (const Json& check : json.at("checks")) part.checks.push_back(check_from(check));
    if (json.contains("walks")) {
      part.terms = terms_from(json.at("walks").at("terms"));
      part.walked = walked_from(json.at("walks").at("found"));
    }
    return part;
  } catch (const nlohmann::json::exception&) {
    throw Error(name + ": no whole report of verify --part");
  } catch (const Error& e) {
    throw Error(name + ": " + e.what());
  }
}

}  // namespace hapgrid
