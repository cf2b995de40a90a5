#include "libcore/model/protocol.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>

#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

using Json = nlohmann::json;

namespace {

constexpr std::size_t kMaxUnit = 15;  // bytes, as in plugin.h
constexpr std::size_t kMaxWord = 100;

[[noreturn]] void fail(const std::string& what) { throw ModelError(what); }

double number(const Json& in, const char* key) {
  const auto at = in.find(key);
  if (at == in.end()) fail(format("its first line has no \"{}\"", key));
  if (!at->is_number()) fail(format("\"{}\" must be a number", key));
  return at->get<double>();
}

double number(const Json& in, const char* key, double default_value) {
  return in.contains(key) ? number(in, key) : default_value;
}

std::uint32_t whole_number(const Json& in, const char* key, std::uint32_t most) {
  const double value = number(in, key);
  if (!(value >= 1 && value <= most) || value != std::floor(value))
    fail(format("\"{}\" must be a whole number from 1 to {}", key, most));
  return static_cast<std::uint32_t>(value);
}

std::string text(const Json& in, const char* key, std::size_t limit) {
  const auto at = in.find(key);
  if (at == in.end()) return "";
  if (!at->is_string()) fail(format("\"{}\" must be a text", key));
  const std::string value = at->get<std::string>();
  if (value.size() > limit) fail(format("\"{}\" has more than {} bytes", key, limit));
  return printable_line(value);
}

const Json& array(const Json& in, const char* key) {
  static const Json none = Json::array();
  const auto at = in.find(key);
  if (at == in.end()) return none;
  if (!at->is_array()) fail(format("\"{}\" must be an array", key));
  return *at;
}

void only_keys(const Json& in, const std::string& where,
               std::initializer_list<std::string_view> known) {
  for (const auto& [key, value] : in.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string names;
    for (const std::string_view k : known) names += (names.empty() ? "" : ", ") + std::string(k);
    fail(format("unknown key \"{}\" in {} (known: {})", printable_line(key), where, names));
  }
}

Sphere read_sphere(const Json& in) {
  if (!in.is_object()) fail("\"spheres\" must be an array of objects");
  only_keys(in, "a sphere", {"radius", "colour", "label"});
  Sphere sphere;
  sphere.radius = static_cast<float>(number(in, "radius"));
  const Json& colour = array(in, "colour");
  if (!colour.empty() && colour.size() != 3) fail("a sphere's \"colour\" has three numbers");
  sphere.colour = {0.8F, 0.8F, 0.8F};
  for (std::size_t i = 0; i < colour.size(); ++i) {
    if (!colour[i].is_number()) fail("a sphere's \"colour\" has three numbers");
    const double c = colour[i].get<double>();
    if (!(c >= 0 && c <= 1)) fail("a sphere's colour is not within 0 and 1");
    sphere.colour[i] = static_cast<float>(c);
  }
  sphere.label = text(in, "label", kMaxLabelSize);
  return sphere;
}

Equality read_equality(const Json& in, std::uint32_t state_size) {
  Equality equality;
  const std::string norm = in.contains("norm") ? text(in, "norm", kMaxWord) : "max";
  if (norm != "max" && norm != "rms") fail("\"norm\" must be \"max\" or \"rms\"");
  equality.norm = norm == "max" ? Equality::Norm::kMax : Equality::Norm::kRms;
  for (const Json& weight : array(in, "weights")) {
    if (!weight.is_number()) fail("\"weights\" must be an array of numbers");
    equality.weights.push_back(weight.get<double>());
  }
  for (const Json& period : array(in, "period")) {
    if (!period.is_number()) fail("\"period\" must be an array of numbers");
    equality.periods.push_back(period.get<double>());
  }
  if (!equality.fits_periods(state_size))
    fail(format(
        "\"period\" must be {} numbers, one for each component of the state: 0, the period of "
        "an angle, or six times -1 for two columns of a rotation matrix",
        state_size));
  if (!equality.fits(state_size))
    fail(
        format("\"weights\" must be {} numbers, one for each component of the state, none of them "
               "negative",
               state_size));
  return equality;
}

Stored read_stored(const Json& in) {
  Stored stored;
  for (const Json& kept : array(in, "stored")) {
    const std::string what = kept.is_string() ? kept.get<std::string>() : "";
    if (what != "force" && what != "energy" && what != "shape")
      fail("\"stored\" must be an array of \"force\", \"energy\" and \"shape\"");
    (what == "force" ? stored.force : what == "energy" ? stored.energy : stored.shape) = true;
  }
  return stored;
}

ModelInfo read_info(const Json& in) {
  if (!in.is_object()) fail("its first line is no JSON object");
  if (in.contains("error")) throw RefusedError(text(in, "error", std::string::npos));
  const auto version = in.find("hapgrid");
  if (version == in.end()) fail("its first line has no \"hapgrid\", the version of the protocol");
  if (!version->is_number_integer() || *version != kProtocolVersion)
    fail(format("it speaks version {} of the protocol, this hapgrid speaks {}",
                printable_line(version->dump(-1, ' ', true)), kProtocolVersion));
  only_keys(in, "its first line",
            {"hapgrid", "state_size", "d_max", "tolerance", "tolerance_unit", "norm", "weights",
             "period", "length_unit", "energy_unit", "force_scale", "hip_radius", "stored",
             "spheres", "version", "in_flight", "processes"});
  ModelInfo info;
  info.state_size = whole_number(in, "state_size", kMaxStateSize);
  info.in_flight = in.contains("in_flight") ? whole_number(in, "in_flight", kMaxInFlight) : 0;
  info.processes = in.contains("processes") ? whole_number(in, "processes", kMaxInFlight) : 0;
  info.d_max = number(in, "d_max");
  info.tolerance = number(in, "tolerance");
  info.tolerance_unit = text(in, "tolerance_unit", kMaxUnit);
  info.length_unit = text(in, "length_unit", kMaxUnit);
  info.energy_unit = text(in, "energy_unit", kMaxUnit);
  info.version = text(in, "version", kMaxWord);
  info.force_scale = number(in, "force_scale", 0);
  info.hip_radius = number(in, "hip_radius", 0);
  info.equality = read_equality(in, info.state_size);
  info.stored = read_stored(in);
  const Json& spheres = array(in, "spheres");
  require_possible_shape(spheres.size());
  if (info.stored.shape == spheres.empty())
    fail("\"spheres\" and the \"shape\" in \"stored\" go together");
  for (const Json& sphere : spheres) info.spheres.push_back(read_sphere(sphere));
  info.validate();
  return info;
}

}  // namespace

std::string handshake_line(const std::vector<Parameter>& parameters) {
  Json all = Json::object();
  for (const Parameter& p : parameters) {
    const auto require_finite = [&p](double number) {
      if (!std::isfinite(number))
        fail(
            format("parameter {} is not finite, which JSON cannot express", printable_line(p.key)));
    };
    if (const auto* one = std::get_if<double>(&p.value)) require_finite(*one);
    if (const auto* many = std::get_if<std::vector<double>>(&p.value))
      std::for_each(many->begin(), many->end(), require_finite);
    all[p.key] = std::visit([](const auto& value) { return Json(value); }, p.value);
  }
  try {
    return Json{{"hapgrid", kProtocolVersion}, {"parameters", std::move(all)}}.dump() + "\n";
  } catch (const Json::exception&) {
    fail("a parameter's text is no UTF-8, which JSON cannot express");
  }
}

void require_object(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::string_view rest = line;
  const auto skip_blanks = [&] {
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
  };
  skip_blanks();
  if (rest.starts_with('{')) {
    rest.remove_prefix(1);
    skip_blanks();
    if (rest.starts_with('"') || rest.starts_with('}')) return;
  }
  throw LastingError(
      format("printed '{}' to standard output, which is for its answers: what a model prints must "
             "go to standard error, in Python with print(..., file=sys.stderr) in place of print()",
             printable_line(line)));
}

ModelInfo read_first_line(std::string_view line) {
  require_object(line);
  if (nests_too_deep(line))
    fail(format("its first line nests deeper than {} levels", kMaxJsonDepth));
  Json in;
  try {
    in = parse_json(line);
  } catch (const Json::exception& e) {
    fail("its first line is no JSON: " + json_reason(e));
  }
  return read_info(in);
}

std::string json_reason(const std::exception& e) {
  const std::string what = e.what();
  const std::size_t end = what.find("] ");  // of "[json.exception...] "
  return printable_line(end == what.npos ? what : what.substr(end + 2));
}

namespace {

constexpr std::size_t kNumberBytes = 64;  // sign, 17 digits, point, exponent, comma, and blanks
constexpr std::size_t kLineBytes = 4096;  // for all of an answer that is no array

[[noreturn]] void wrong_type(const char* key) { fail(format("\"{}\" is of the wrong type", key)); }

double number_of(const Json& in, const char* key) {
  if (!in.is_number()) wrong_type(key);
  // The parser keeps -0 as a whole number with a sign, and no other zero is one.
  if (in.is_number_integer() && !in.is_number_unsigned() && in == 0) return -0.0;
  return in.get<double>();
}

void append_array(const Json& in, const char* key, std::vector<double>& numbers) {
  if (!in.is_array()) wrong_type(key);
  for (const Json& entry : in) numbers.push_back(number_of(entry, key));
}

Answer read_tree(const Json& in) {
  Answer answer;
  for (const auto& [name, value] : in.get_ref<const Json::object_t&>()) {
    const char* const key = name.c_str();
    if (name == "id") {
      if (!value.is_number_unsigned()) wrong_type(key);
      answer.id = value.get<std::uint64_t>();
    } else if (name == "error") {
      if (!value.is_string()) wrong_type(key);
      answer.error = printable_line(value.get_ref<const std::string&>());
    } else if (name == "energy") {
      answer.energy.push_back(number_of(value, key));
    } else if (name == "s") {
      append_array(value, key, answer.s);
    } else if (name == "force") {
      append_array(value, key, answer.force);
    } else if (name == "shape") {
      append_array(value, key, answer.shape);
    } else if (name == "states") {
      if (!value.is_array()) wrong_type(key);
      answer.states.emplace();
      for (const Json& state : value) append_array(state, key, answer.states->emplace_back());
    }
  }
  if (!in.contains("id")) fail("no whole number \"id\"");
  return answer;
}

void append_numbers(std::string& text, const char* key, const double* numbers, std::size_t count) {
  text += key;
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) text += ", ";
    append_number(text, numbers[i]);
  }
  text += ']';
}

void require_count(const char* what, std::size_t got, std::size_t expected) {
  if (got == expected) return;
  fail(format("an answer with {} numbers in \"{}\", not {}", got, what, expected));
}

}  // namespace

void append_number(std::string& text, double value) {
  char digits[32];
  char* end = std::to_chars(digits, digits + sizeof digits - 2, value).ptr;
  if (std::none_of(digits, end, [](char c) { return c == '.' || c == 'e'; })) {
    *end++ = '.';
    *end++ = '0';
  }
  text.append(digits, end);
}

void append_question(std::string& text, std::uint64_t id, Operation operation, std::uint32_t n,
                     const double* s, const Vec3& x, const Vec3& d) {
  static constexpr const char* kNames[] = {"convert", "known_states", "evaluate"};
  char digits[24];
  text += "{\"id\": ";
  text.append(digits, std::to_chars(digits, digits + sizeof digits, id).ptr);
  text += ", \"op\": \"";
  text += kNames[static_cast<int>(operation)];
  text += '"';
  if (operation != Operation::kKnownStates) append_numbers(text, ", \"s\": [", s, n);
  append_numbers(text, ", \"x\": [", x.data(), 3);
  if (operation == Operation::kConvert) append_numbers(text, ", \"d\": [", d.data(), 3);
  text += "}\n";
}

std::size_t max_answer_bytes(const ModelInfo& model, Operation operation) {
  return kLineBytes + kNumberBytes * (operation == Operation::kKnownStates
                                          ? std::size_t{kMaxLevels} * model.state_size
                                          : model.row_size());
}

Answer read_answer(std::string_view line) {
  require_object(line);
  std::string why;
  try {
    if (nests_too_deep(line)) fail(format("nested deeper than {} levels", kMaxJsonDepth));
    return read_tree(parse_json(line));
  } catch (const Json::exception& e) {
    why = "no JSON: " + json_reason(e);
  } catch (const ModelError& e) {
    why = e.what();
  }
  fail(format("answered '{}': {}", printable_line(line), why));
}

void write_row(const Answer& answer, const ModelInfo& model, Operation operation, double* row) {
  const Stored& stored = model.stored;
  if (operation == Operation::kConvert) {
    require_count("s", answer.s.size(), model.state_size);
    std::copy(answer.s.begin(), answer.s.end(), row);
  }
  double* out = row + model.state_size;
  const auto append = [&out](const char* what, const std::vector<double>& numbers,
                             std::size_t expected) {
    require_count(what, numbers.size(), expected);
    out = std::copy(numbers.begin(), numbers.end(), out);
  };
  if (stored.force) append("force", answer.force, 3);
  if (stored.energy) append("energy", answer.energy, 1);
  if (stored.shape) {
    require_count("shape", answer.shape.size(), 3 * model.spheres.size());
    for (const double centre : answer.shape) {
      if (!(std::abs(centre) <= std::numeric_limits<float>::max()))
        fail("an answer with a centre in \"shape\" that is too large");
      *out++ = static_cast<float>(centre);
    }
  }
}

std::vector<double> states_of(const Answer& answer, const ModelInfo& model) {
  if (!answer.states) fail("an answer without \"states\"");
  std::vector<double> rows;
  for (const std::vector<double>& state : *answer.states) {
    if (state.size() != model.state_size)
      fail(format("an answer with a state of {} components, not {}", state.size(),
                  model.state_size));
    rows.insert(rows.end(), state.begin(), state.end());
  }
  if (answer.states->size() > static_cast<std::size_t>(kMaxLevels))
    fail(format("{} states at one point, the limit is {}", answer.states->size(),
                static_cast<std::size_t>(kMaxLevels)));
  return rows;
}

}  // namespace hapgrid
