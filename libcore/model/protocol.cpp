#include "libcore/model/protocol.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>

namespace hapgrid {

using Json = nlohmann::json;

namespace {

constexpr std::size_t kShown = 200;       // of what a model wrote, in a message
constexpr std::size_t kNumberBytes = 64;  // sign, 17 digits, point, exponent, comma, and blanks
constexpr std::size_t kLineBytes = 4096;  // everything in an answer that is no array
constexpr std::size_t kMaxUnit = 15;      // bytes, as in plugin.h

[[noreturn]] void fail(const std::string& what) { throw ModelError(what); }

/// What nlohmann's exceptions say, without their own prefix "[json.exception...] ".
std::string reason(const Json::exception& e) {
  const std::string what = e.what();
  const std::size_t end = what.find("] ");
  return printable_line(end == what.npos ? what : what.substr(end + 2));
}

// ---- the description ------------------------------------------------------------------------

double number(const Json& in, const char* key) {
  const auto at = in.find(key);
  if (at == in.end()) fail(std::string("its description has no \"") + key + "\"");
  if (!at->is_number()) fail(std::string("\"") + key + "\" must be a number");
  return at->get<double>();
}

double number(const Json& in, const char* key, double default_value) {
  return in.contains(key) ? number(in, key) : default_value;
}

std::string text(const Json& in, const char* key, std::size_t limit) {
  const auto at = in.find(key);
  if (at == in.end()) return "";
  if (!at->is_string()) fail(std::string("\"") + key + "\" must be a text");
  const std::string value = at->get<std::string>();
  if (value.size() > limit)
    fail(std::string("\"") + key + "\" has more than " + std::to_string(limit) + " bytes");
  return printable_line(value);
}

const Json& array(const Json& in, const char* key) {
  static const Json none = Json::array();
  const auto at = in.find(key);
  if (at == in.end()) return none;
  if (!at->is_array()) fail(std::string("\"") + key + "\" must be an array");
  return *at;
}

void only_keys(const Json& in, const std::string& where,
               std::initializer_list<std::string_view> known) {
  for (const auto& [key, value] : in.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string names;
    for (const std::string_view k : known) names += (names.empty() ? "" : ", ") + std::string(k);
    fail("unknown key \"" + printable_line(key) + "\" in " + where + " (known: " + names + ")");
  }
}

Sphere read_sphere(const Json& in) {
  if (!in.is_object()) fail("\"spheres\" must be an array of objects");
  only_keys(in, "a sphere", {"radius", "colour", "label"});
  Sphere sphere;
  sphere.radius = static_cast<float>(number(in, "radius"));
  if (!std::isfinite(sphere.radius) || sphere.radius < 0)
    fail("a sphere whose radius is negative or too large");
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

Description describe(const Json& in) {
  if (!in.is_object()) fail("its first line is no JSON object");
  if (in.contains("error")) throw RefusedError(text(in, "error", std::string::npos));
  const auto version = in.find("hapgrid");
  if (version == in.end()) fail("its first line has no \"hapgrid\", the version of the protocol");
  if (!version->is_number_integer() || *version != kProtocolVersion)
    fail("it speaks version " + printable_line(version->dump(-1, ' ', true)) +
         " of the protocol, this hapgrid speaks " + std::to_string(kProtocolVersion));
  only_keys(in, "its description",
            {"hapgrid", "state_size", "d_max", "tolerance", "tolerance_unit", "norm", "weights",
             "length_unit", "energy_unit", "force_scale", "hip_radius", "stored", "spheres"});
  Description d;
  const double size = number(in, "state_size");
  if (!(size >= 1 && size <= kMaxStateSize) || size != std::floor(size))
    fail("\"state_size\" must be a whole number from 1 to " + std::to_string(kMaxStateSize));
  d.state_size = static_cast<std::uint32_t>(size);
  d.d_max = number(in, "d_max");
  if (!(d.d_max > 0)) fail("\"d_max\" must be positive");
  d.tolerance = number(in, "tolerance");
  if (!(d.tolerance >= 0)) fail("\"tolerance\" must not be negative");
  d.tolerance_unit = text(in, "tolerance_unit", kMaxUnit);
  d.length_unit = text(in, "length_unit", kMaxUnit);
  d.energy_unit = text(in, "energy_unit", kMaxUnit);
  d.force_scale = number(in, "force_scale", 0);
  d.hip_radius = number(in, "hip_radius", 0);
  if (!(d.hip_radius >= 0)) fail("\"hip_radius\" must not be negative");

  const std::string norm = in.contains("norm") ? text(in, "norm", kLineBytes) : "max";
  if (norm != "max" && norm != "rms") fail("\"norm\" must be \"max\" or \"rms\"");
  d.equality.norm = norm == "max" ? Equality::Norm::kMax : Equality::Norm::kRms;
  for (const Json& weight : array(in, "weights")) {
    if (!weight.is_number()) fail("\"weights\" must be an array of numbers");
    d.equality.weights.push_back(weight.get<double>());
  }
  if (!d.equality.fits(d.state_size))
    fail("\"weights\" must be " + std::to_string(d.state_size) +
         " numbers, one a component of the state, none of them negative");

  for (const Json& kept : array(in, "stored")) {
    const std::string what = kept.is_string() ? kept.get<std::string>() : "";
    if (what == "force") {
      d.stored.force = true;
    } else if (what == "energy") {
      d.stored.energy = true;
    } else if (what == "shape") {
      d.stored.shape = true;
    } else {
      fail("\"stored\" must be an array of \"force\", \"energy\" and \"shape\"");
    }
  }
  const Json& spheres = array(in, "spheres");
  if (spheres.size() > kMaxSpheres)
    fail("a shape of " + std::to_string(spheres.size()) + " spheres; " +
         std::to_string(kMaxSpheres) + " are possible");
  if (d.stored.shape == spheres.empty())
    fail("\"spheres\" and the \"shape\" in \"stored\" go together");
  for (const Json& sphere : spheres) d.spheres.push_back(read_sphere(sphere));
  return d;
}

// ---- answers --------------------------------------------------------------------------------

/// Takes an answer apart while it is parsed: no tree of the line is built. Keys that nobody knows
/// are passed over.
class AnswerReader final : public nlohmann::json_sax<Json> {
 public:
  explicit AnswerReader(Answer& answer) : answer_(answer) {
    answer.id = 0;
    answer.has_error = answer.has_states = false;
    for (auto* numbers : {&answer.s, &answer.force, &answer.shape, &answer.states, &answer.energy})
      numbers->clear();
    answer.states_sizes.clear();
  }
  const std::string& failure() const { return failure_; }
  bool has_id() const { return has_id_; }

  bool null() override { return other(); }
  bool boolean(bool) override { return other(); }
  bool binary(binary_t&) override { return other(); }
  // The parser hands over whole numbers with a sign here, and no other zero than -0 has one.
  bool number_integer(number_integer_t value) override {
    return take(value == 0 ? -0.0 : static_cast<double>(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    if (depth_ == 1 && field_ == Field::kId) {
      answer_.id = value;
      has_id_ = true;
      return true;
    }
    return take(static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t&) override { return take(value); }
  bool string(string_t& value) override {
    if (depth_ == 1 && field_ == Field::kError) {
      answer_.has_error = true;
      answer_.error = printable_line(value);
      return true;
    }
    return other();
  }
  bool start_object(std::size_t) override {
    if (depth_ > 0 && !other()) return false;
    ++depth_;
    objects_ += depth_ > 1;
    return true;
  }
  bool end_object() override {
    --depth_;
    objects_ -= depth_ > 0;
    return true;
  }
  bool key(string_t& key) override {
    if (depth_ != 1) return true;
    static constexpr std::pair<std::string_view, Field> kFields[] = {
        {"s", Field::kState},     {"id", Field::kId},         {"force", Field::kForce},
        {"shape", Field::kShape}, {"energy", Field::kEnergy}, {"states", Field::kStates},
        {"error", Field::kError}};
    field_ = Field::kOther;
    for (const auto& [name, field] : kFields)
      if (key == name) field_ = field;
    return true;
  }
  bool start_array(std::size_t) override {
    if (depth_ == 0) return complain("no JSON object");
    const bool wanted =
        objects_ == 0 && ((depth_ == 1 && numbers() != nullptr && field_ != Field::kEnergy) ||
                          (depth_ == 2 && field_ == Field::kStates));
    if (!wanted && !other()) return false;
    if (field_ == Field::kStates && depth_ == 1) answer_.has_states = true;
    if (field_ == Field::kStates && depth_ == 2) answer_.states_sizes.push_back(0);
    ++depth_;
    return true;
  }
  bool end_array() override {
    --depth_;
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const Json::exception& e) override {
    failure_ = "no JSON: " + reason(e);
    return false;
  }

 private:
  enum class Field { kOther, kId, kError, kState, kForce, kShape, kEnergy, kStates };

  std::vector<double>* numbers() {
    switch (field_) {
      case Field::kState:
        return &answer_.s;
      case Field::kForce:
        return &answer_.force;
      case Field::kShape:
        return &answer_.shape;
      case Field::kEnergy:
        return &answer_.energy;
      case Field::kStates:
        return &answer_.states;
      default:
        return nullptr;
    }
  }
  bool take(double value) {
    const int depth = field_ == Field::kEnergy ? 1 : field_ == Field::kStates ? 3 : 2;
    std::vector<double>* to = numbers();
    if (!to || objects_ > 0 || depth_ != depth) return other();
    to->push_back(value);
    if (field_ == Field::kStates) ++answer_.states_sizes.back();
    return true;
  }
  /// Something that is no number where it should be one; anything is right in a key that is not
  /// known.
  bool other() {
    if (depth_ == 0) return complain("no JSON object");
    if (field_ == Field::kOther) return true;
    static constexpr const char* kNames[] = {"",      "id",    "error",  "s",
                                             "force", "shape", "energy", "states"};
    return complain(std::string("\"") + kNames[static_cast<int>(field_)] +
                    "\" is of the wrong type");
  }
  bool complain(const std::string& what) {
    failure_ = what;
    return false;
  }

  Answer& answer_;
  int depth_ = 0;    // brackets that are open
  int objects_ = 0;  // of them, objects inside the answer
  Field field_ = Field::kOther;
  bool has_id_ = false;
  std::string failure_;
};

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
  fail(std::string("an answer with ") + std::to_string(got) + " numbers in \"" + what + "\", not " +
       std::to_string(expected));
}

}  // namespace

std::string printable_line(std::string_view text) {
  text = text.substr(0, kShown);
  std::string line;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    // What is no UTF-8, or was cut, would not be shown or could not be searched for.
    const std::size_t length = byte < 0x80   ? 1
                               : byte < 0xc2 ? 0
                               : byte < 0xe0 ? 2
                               : byte < 0xf0 ? 3
                                             : 4;
    bool whole = length > 0 && byte < 0xf5 && i + length <= text.size();
    for (std::size_t k = 1; whole && k < length; ++k)
      whole = (static_cast<unsigned char>(text[i + k]) & 0xc0) == 0x80;
    if (!whole) {
      line += '?';
    } else if (byte < 0x20 || byte == 0x7f) {
      line += ' ';
    } else {
      line += text.substr(i, length);
    }
    i += whole ? length : 1;
  }
  return line;
}

std::string handshake_line(const std::vector<Parameter>& parameters) {
  Json all = Json::object();
  for (const Parameter& p : parameters) {
    const auto require_finite = [&p](double number) {
      if (!std::isfinite(number))
        fail("parameter " + printable_line(p.key) + " is not finite, which JSON cannot say");
    };
    if (const auto* one = std::get_if<double>(&p.value)) require_finite(*one);
    if (const auto* many = std::get_if<std::vector<double>>(&p.value))
      std::for_each(many->begin(), many->end(), require_finite);
    all[p.key] = std::visit([](const auto& value) { return Json(value); }, p.value);
  }
  try {
    return Json{{"hapgrid", kProtocolVersion}, {"parameters", std::move(all)}}.dump() + "\n";
  } catch (const Json::exception&) {
    fail("a parameter's text is no UTF-8, which JSON cannot say");
  }
}

Description read_description(std::string_view line) {
  Json in;
  try {
    in = Json::parse(line);
  } catch (const Json::exception& e) {
    fail("its first line is no JSON: " + reason(e));
  }
  return describe(in);
}

void append_number(std::string& text, double value) {
  char digits[32];
  char* end = std::to_chars(digits, digits + sizeof digits - 2, value).ptr;
  if (std::none_of(digits, end, [](char c) { return c == '.' || c == 'e'; })) {
    *end++ = '.';
    *end++ = '0';
  }
  text.append(digits, end);
}

void append_request(std::string& text, std::uint64_t id, Operation operation, std::uint32_t n,
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

std::size_t max_answer_bytes(const Description& description, Operation operation) {
  return kLineBytes + kNumberBytes * (operation == Operation::kKnownStates
                                          ? std::size_t{kMaxLevels} * description.state_size
                                          : description.row_size());
}

void read_answer(std::string_view line, Answer& answer) {
  AnswerReader reader(answer);
  const bool parsed = Json::sax_parse(line, &reader);
  std::string why = reader.failure();
  if (parsed && !reader.has_id()) why = "no whole number \"id\"";
  if (!parsed || !why.empty()) fail("answered '" + printable_line(line) + "': " + why);
}

void take_row(const Answer& answer, const Description& description, Operation operation,
              double* row) {
  const Stored& stored = description.stored;
  if (operation == Operation::kConvert) {
    require_count("s", answer.s.size(), description.state_size);
    std::copy(answer.s.begin(), answer.s.end(), row);
  }
  double* out = row + description.state_size;
  const auto keep = [&out](const char* what, const std::vector<double>& numbers,
                           std::size_t expected) {
    require_count(what, numbers.size(), expected);
    out = std::copy(numbers.begin(), numbers.end(), out);
  };
  if (stored.force) keep("force", answer.force, 3);
  if (stored.energy) keep("energy", answer.energy, 1);
  if (stored.shape) {
    require_count("shape", answer.shape.size(), 3 * description.spheres.size());
    for (const double centre : answer.shape) {
      if (!(std::abs(centre) <= std::numeric_limits<float>::max()))
        fail("an answer with a centre in \"shape\" that is too large");
      *out++ = static_cast<float>(centre);
    }
  }
}

std::vector<double> take_states(const Answer& answer, const Description& description) {
  if (!answer.has_states) fail("an answer without \"states\"");
  for (const std::uint32_t size : answer.states_sizes)
    if (size != description.state_size)
      fail("an answer with a state of " + std::to_string(size) + " components, not " +
           std::to_string(description.state_size));
  if (answer.states_sizes.size() > static_cast<std::size_t>(kMaxLevels))
    fail(std::to_string(answer.states_sizes.size()) + " states at one point, the limit is " +
         std::to_string(kMaxLevels));
  return answer.states;
}

}  // namespace hapgrid
