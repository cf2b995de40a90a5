// The first line to a model process and the first one back (PROTOCOL.md): the parameters, and what
// the model says of itself.
#pragma once

#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// Raised by every change that a model would notice.
inline constexpr unsigned kProtocolVersion = 1;

/// The longest line that a model may begin with: a million spheres fit.
inline constexpr std::size_t kMaxFirstLineBytes = std::size_t{128} << 20;

/// The first line to the model, with its end. @throw ModelError for a parameter that JSON cannot
/// express: a number that is not finite, a text that is no UTF-8.
std::string handshake_line(const std::vector<Parameter>& parameters);

/// What a process would do again, were it asked again.
class LastingError : public ModelError {
 public:
  using ModelError::ModelError;
};

/// A model that refuses its parameters: {"error": "..."}.
class RefusedError : public LastingError {
 public:
  using LastingError::LastingError;
};

/// The first line from the model. @throw RefusedError; LastingError where something was printed
/// instead; ModelError. All are one line without the model's name.
ModelInfo read_first_line(std::string_view line);

/// @throw LastingError when the line begins otherwise than a JSON object does: then the model, or a
/// library of its, has printed it.
void require_object(std::string_view line);

/// What a JSON parser says, in one printable line and without its own prefix.
std::string json_reason(const std::exception& e);

}  // namespace hapgrid
