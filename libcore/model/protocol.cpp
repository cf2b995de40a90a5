#include "libcore/model/protocol.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>

#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

using Json = nlohmann::json;

namespace {

constexpr std::size_t kNumberBytes = 64;  // sign, 17 digits, point, exponent, comma, and blanks
constexpr std::size_t kLineBytes = 4096;  // everything in an answer that is no array

[[noreturn]] void wrong_answer(const std::string& what) { throw ModelError(what); }

/// Takes an answer apart while it is parsed: no tree of the line is built. Unknown keys are passed
/// over.
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
    if (!open()) return false;
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
    return open();
  }
  bool end_array() override {
    --depth_;
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const Json::exception& e) override {
    failure_ = "no JSON: " + json_reason(e);
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
  /// Takes a value that is none of the numbers wanted: right only under an unknown key.
  bool other() {
    if (depth_ == 0) return complain("no JSON object");
    if (field_ == Field::kOther) return true;
    static constexpr const char* kNames[] = {"",      "id",    "error",  "s",
                                             "force", "shape", "energy", "states"};
    return complain(std::string("\"") + kNames[static_cast<int>(field_)] +
                    "\" is of the wrong type");
  }
  bool open() {
    return ++depth_ <= static_cast<int>(kMaxJsonDepth) ||
           complain("nested deeper than " + std::to_string(kMaxJsonDepth) + " levels");
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
  wrong_answer(std::string("an answer with ") + std::to_string(got) + " numbers in \"" + what +
               "\", not " + std::to_string(expected));
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

void read_answer(std::string_view line, Answer& answer) {
  require_object(line);
  AnswerReader reader(answer);
  const bool parsed = Json::sax_parse(line, &reader);
  std::string why = reader.failure();
  if (parsed && !reader.has_id()) why = "no whole number \"id\"";
  if (!parsed || !why.empty()) wrong_answer("answered '" + printable_line(line) + "': " + why);
}

void take_row(const Answer& answer, const ModelInfo& model, Operation operation, double* row) {
  const Stored& stored = model.stored;
  if (operation == Operation::kConvert) {
    require_count("s", answer.s.size(), model.state_size);
    std::copy(answer.s.begin(), answer.s.end(), row);
  }
  double* out = row + model.state_size;
  const auto keep = [&out](const char* what, const std::vector<double>& numbers,
                           std::size_t expected) {
    require_count(what, numbers.size(), expected);
    out = std::copy(numbers.begin(), numbers.end(), out);
  };
  if (stored.force) keep("force", answer.force, 3);
  if (stored.energy) keep("energy", answer.energy, 1);
  if (stored.shape) {
    require_count("shape", answer.shape.size(), 3 * model.spheres.size());
    for (const double centre : answer.shape) {
      if (!(std::abs(centre) <= std::numeric_limits<float>::max()))
        wrong_answer("an answer with a centre in \"shape\" that is too large");
      *out++ = static_cast<float>(centre);
    }
  }
}

std::vector<double> take_states(const Answer& answer, const ModelInfo& model) {
  if (!answer.has_states) wrong_answer("an answer without \"states\"");
  for (const std::uint32_t size : answer.states_sizes)
    if (size != model.state_size)
      wrong_answer("an answer with a state of " + std::to_string(size) + " components, not " +
                   std::to_string(model.state_size));
  if (answer.states_sizes.size() > static_cast<std::size_t>(kMaxLevels))
    wrong_answer(std::to_string(answer.states_sizes.size()) +
                 " states at one point, the limit is " + std::to_string(kMaxLevels));
  return answer.states;
}

}  // namespace hapgrid
