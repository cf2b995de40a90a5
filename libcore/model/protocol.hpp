// Questions to a model process and its answers (PROTOCOL.md). Answers are not trusted.
#pragma once

#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

// The first line to a model process and the first one back (PROTOCOL.md): the parameters, and what
// the model says of itself.

/// The version increases with every change of the protocol that a model would notice.
inline constexpr unsigned kProtocolVersion = 1;

/// The longest line that a model may begin with: a million spheres fit.
inline constexpr std::size_t kMaxFirstLineBytes = std::size_t{128} << 20;

/// The first line to the model, with its end. @throw ModelError for a parameter that JSON cannot
/// express: a number that is not finite, a text that is no UTF-8.
std::string handshake_line(const std::vector<Parameter>& parameters);

/// A failure that would occur again if the process were asked again.
class LastingError : public ModelError {
 public:
  using ModelError::ModelError;
};

/// A model that refuses its parameters: {"error": "..."}.
class RefusedError : public LastingError {
 public:
  using LastingError::LastingError;
};

/// Reads the first line from the model. @throw RefusedError; LastingError when the model printed
/// something else; ModelError. Each message is one line without the model's name.
ModelInfo read_first_line(std::string_view line);

/// @throw LastingError when the line does not begin like a JSON object. The model, or a library
/// that it uses, has then printed text to its standard output.
void require_object(std::string_view line);

/// The message of a JSON parser, in one printable line and without the parser's prefix.
std::string json_reason(const std::exception& e);

/// Appends a number that reads back to the same double. It always has a point or an exponent:
/// a language with whole numbers would otherwise read one, and -0 would lose its sign.
void append_number(std::string& text, double value);

enum class Operation { kConvert, kKnownStates, kEvaluate };

/// Appends one question with its end. kKnownStates does not use `s` (n components); only kConvert
/// uses `d`.
void append_question(std::string& text, std::uint64_t id, Operation operation, std::uint32_t n,
                     const double* s, const Vec3& x, const Vec3& d);

/// The largest size of an answer. All its numbers fit, with many blanks and digits.
std::size_t max_answer_bytes(const ModelInfo& model, Operation operation);

/// One answer. An array that it does not have is empty.
struct Answer {
  std::uint64_t id = 0;
  std::optional<std::string> error;
  std::vector<double> s, force, shape;
  std::vector<double> energy;  ///< one number or none
  std::optional<std::vector<std::vector<double>>> states;
};

/// Unknown keys are ignored.
/// @throw LastingError as require_object(); ModelError, one line, when the line is no JSON, has no
/// id, or an entry is of the wrong type.
Answer read_answer(std::string_view line);

/// Writes the row of an answer: the state, then what is stored with it. An answer to kEvaluate has
/// no state, and the state in `row` stays as it is.
/// @throw ModelError when there are too few or too many numbers, or one is too large.
void write_row(const Answer& answer, const ModelInfo& model, Operation operation, double* row);

/// The known states of an answer, row after row. @throw ModelError
std::vector<double> states_of(const Answer& answer, const ModelInfo& model);

}  // namespace hapgrid
