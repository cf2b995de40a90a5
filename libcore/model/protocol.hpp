// The lines between hapgrid and a model process, as PROTOCOL.md describes them: written by hand,
// since there are millions of them, and read with a parser that takes nothing for granted.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/grid/spec.hpp"

namespace hapgrid {

/// Raised by every change that a model would notice.
inline constexpr unsigned kProtocolVersion = 1;

/// The longest line that a model may begin with: a million spheres fit.
inline constexpr std::size_t kMaxDescriptionBytes = std::size_t{128} << 20;

/// What a model process says of itself before anything else.
struct Description {
  std::uint32_t state_size = 0;
  double d_max = 0;
  double tolerance = 0;
  std::string tolerance_unit, length_unit, energy_unit;
  double force_scale = 0;
  double hip_radius = 0;
  Equality equality;
  Stored stored;
  std::vector<Sphere> spheres;  ///< none unless the shape is stored

  std::uint32_t row_size() const {
    return state_size + (stored.force ? 3 : 0) + (stored.energy ? 1 : 0) +
           3 * static_cast<std::uint32_t>(spheres.size());
  }
  friend bool operator==(const Description&, const Description&) = default;
};

/// The first line to the model, with its end. @throw ModelError for a parameter that JSON cannot
/// tell: a number that is not finite, a text that is no UTF-8.
std::string handshake_line(const std::vector<Parameter>& parameters);

/// A model that refuses its parameters: {"error": "..."}; nothing is gained by asking again.
class RefusedError : public ModelError {
 public:
  using ModelError::ModelError;
};

/// The model's answer to it. @throw RefusedError; ModelError, one line without the model's name.
Description read_description(std::string_view line);

/// Appends a number that reads back to the same double. It always has a point or an exponent, so
/// that a language with whole numbers does not take it for one: -0 would lose its sign.
void append_number(std::string& text, double value);

enum class Operation { kConvert, kKnownStates, kEvaluate };

/// Appends one request with its end. `s` (n components) is not used by kKnownStates, `d` by
/// kConvert alone.
void append_request(std::string& text, std::uint64_t id, Operation operation, std::uint32_t n,
                    const double* s, const Vec3& x, const Vec3& d);

/// The longest answer: generous blanks and digits for all numbers it can have.
std::size_t max_answer_bytes(const Description& description, Operation operation);

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

/// @throw ModelError, one line: no JSON, no object, an id that is missing, entries of wrong types.
void read_answer(std::string_view line, Answer& answer);

/// Writes an answer's row: state and what is stored with it. kEvaluate answers no state, and that
/// part of `row` stays as it is.
/// @throw ModelError when a number is missing, too much or too large.
void take_row(const Answer& answer, const Description& description, Operation operation,
              double* row);

/// An answer's known states, row after row. @throw ModelError
std::vector<double> take_states(const Answer& answer, const Description& description);

/// One line of at most some hundred bytes, whatever somebody else wrote.
std::string printable_line(std::string_view text);

}  // namespace hapgrid
