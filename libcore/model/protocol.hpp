// Questions to a model process and its answers, as PROTOCOL.md has them: questions are written by
// hand, since there are millions of them, and answers are read by a parser that takes nothing for
// granted.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libcore/model/handshake.hpp"

namespace hapgrid {

/// Appends a number that reads back to the same double. It always has a point or an exponent, so
/// that a language with whole numbers does not take it for one: -0 would lose its sign.
void append_number(std::string& text, double value);

enum class Operation { kConvert, kKnownStates, kEvaluate };

/// Appends one question with its end. kKnownStates does not use `s` (n components); only kConvert
/// uses `d`.
void append_question(std::string& text, std::uint64_t id, Operation operation, std::uint32_t n,
                     const double* s, const Vec3& x, const Vec3& d);

/// The longest answer that is taken: it has room for all numbers, with generous blanks and digits.
std::size_t max_answer_bytes(const ModelInfo& model, Operation operation);

/// One answer; the vectors keep their storage from line to line.
struct Answer {
  std::uint64_t id = 0;
  bool has_error = false;
  std::string error;
  bool has_states = false;
  std::vector<double> s, force, shape, states;
  std::vector<double> energy;               ///< one number or none
  std::vector<std::uint32_t> states_sizes;  ///< how many components each of `states` has
};

/// @throw LastingError as require_object(); ModelError, one line: no JSON, no id, entries of wrong
/// types.
void read_answer(std::string_view line, Answer& answer);

/// Writes an answer's row: the state and what is stored with it. An answer to kEvaluate has no
/// state, and that part of `row` stays as it is.
/// @throw ModelError when there are too few or too many numbers, or one is too large.
void take_row(const Answer& answer, const ModelInfo& model, Operation operation, double* row);

/// An answer's known states, row after row. @throw ModelError
std::vector<double> take_states(const Answer& answer, const ModelInfo& model);

}  // namespace hapgrid
