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

}  // namespace hapgrid
