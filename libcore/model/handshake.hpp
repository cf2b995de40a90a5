// The first line to a model process and the first one back (PROTOCOL.md): the parameters, and what
// the model says of itself.
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

}  // namespace hapgrid
