#include "libcore/model/protocol.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>

#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

using Json = nlohmann::json;

namespace {

constexpr std::size_t kNumberBytes = 64;  // sign, 17 digits, point, exponent, comma, and blanks
constexpr std::size_t kLineBytes = 4096;  // for all of an answer that is no array

[[noreturn]] void wrong_answer(const std::string& what) { throw ModelError(what); }

[[noreturn]] void wrong_type(const char* key) {
  wrong_answer(format("\"{}\" is of the wrong type", key));
}

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
  if (!in.contains("id")) wrong_answer("no whole number \"id\"");
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
  wrong_answer(format("an answer with {} numbers in \"{}\", not {}", got, what, expected));
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
    if (nests_too_deep(line)) wrong_answer(format("nested deeper than {} levels", kMaxJsonDepth));
    return read_tree(parse_json(line));
  } catch (const Json::exception& e) {
    why = "no JSON: " + json_reason(e);
  } catch (const ModelError& e) {
    why = e.what();
  }
  wrong_answer(format("answered '{}': {}", printable_line(line), why));
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
        wrong_answer("an answer with a centre in \"shape\" that is too large");
      *out++ = static_cast<float>(centre);
    }
  }
}

std::vector<double> states_of(const Answer& answer, const ModelInfo& model) {
  if (!answer.states) wrong_answer("an answer without \"states\"");
  std::vector<double> rows;
  for (const std::vector<double>& state : *answer.states) {
    if (state.size() != model.state_size)
      wrong_answer(format("an answer with a state of {} components, not {}", state.size(),
                          model.state_size));
    rows.insert(rows.end(), state.begin(), state.end());
  }
  if (answer.states->size() > static_cast<std::size_t>(kMaxLevels))
    wrong_answer(format("{} states at one point, the limit is {}", answer.states->size(),
                        static_cast<std::size_t>(kMaxLevels)));
  return rows;
}

}  // namespace hapgrid
