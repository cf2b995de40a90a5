// How the models in C++ refuse a parameter: in one line that names it, its value and its limits.
#pragma once

#include <cmath>
#include <cstdio>
#include <hapgrid/plugin.hpp>
#include <stdexcept>
#include <string>

namespace hapgrid {

/// A number as a message shows it.
inline std::string decimal(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%g", value);
  return digits;
}

/// @param limit what the value must be: "positive", "from 0 to 1"
/// @throw std::runtime_error always
[[noreturn]] inline void refuse(const std::string& key, double value, const std::string& limit) {
  throw std::runtime_error("parameter " + key + " is " + decimal(value) + ", it must be " + limit);
}

/// The number of that key, `value` when it is not given.
/// @throw std::runtime_error when it is not finite
inline double finite_number(PluginParameters& parameters, const char* key, double value) {
  value = parameters.number(key, value);
  if (!std::isfinite(value)) refuse(key, value, "finite");
  return value;
}

}  // namespace hapgrid
