// What makes two shards parts of the same grid: the description that each header carries.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "libcore/grid/box.hpp"
#include "libcore/grid/equality.hpp"

namespace hapgrid {

/// The value of a model's parameter, as it stands in [model.parameters] of a MODEL.toml.
/// Whole numbers are kept as doubles (a MODEL.toml with one beyond 2^53 is refused).
using ParameterValue =
    std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>>;

struct Parameter {
  std::string key;  ///< tables are flattened: "probe.radius"
  ParameterValue value;
  friend bool operator==(const Parameter&, const Parameter&) = default;
};

/// The largest state size: 2^20 doubles are 8 MiB; more is a mistake or an attack.
inline constexpr std::uint32_t kMaxStateSize = 1u << 20;

/// What a grid keeps beside each state, because the model takes too long for it in the haptic loop
/// (Sect. 2.2). Found once by the search, interpolated by the player.
struct Stored {
  bool force = false;
  bool energy = false;
  bool shape = false;
  friend bool operator==(const Stored&, const Stored&) = default;
};

/// What stays the same of a sphere that shows the model, whatever the state.
struct Sphere {
  float radius = 0;                      ///< the model's unit of length
  std::array<float, 3> colour{0, 0, 0};  ///< red, green, blue in [0, 1]
  std::string label;                     ///< of an atom its element's symbol
  friend bool operator==(const Sphere&, const Sphere&) = default;
};
inline constexpr std::size_t kMaxLabelSize = 7;

/// The most spheres: viewers get them 25 times a second.
inline constexpr std::uint32_t kMaxSpheres = 1u << 20;

/// Everything about a grid that is known before its first record is computed.
///
/// A record's numbers are a row: the state, then what is stored with it, in the order force (3,
/// newtons), energy (1), shape (3 a sphere, x y z, each a float's value).
struct GridSpec {
  Box box;
  std::string model;                  ///< the plug-in's or the process's plain name
  std::vector<Parameter> parameters;  ///< ascending by key
  std::uint32_t state_size = 1;       ///< n, the number of components of a state
  double tolerance = 0;               ///< the bound that the model's tolerance function applies
  std::string tolerance_unit;
  Equality equality;             ///< declared exactly where the model is a process
  std::uint32_t max_levels = 8;  ///< level limit: levels a point may have, 1 .. kMaxLevels
  std::string length_unit;       ///< for people, as the next one; may be empty
  std::string energy_unit;
  double hip_radius = 0;  ///< of the ball that the HIP moves, for pictures; 0: none
  Stored stored;
  std::vector<Sphere> spheres;  ///< where the shape is stored

  std::uint32_t force_offset() const { return state_size; }
  std::uint32_t energy_offset() const { return force_offset() + (stored.force ? 3 : 0); }
  std::uint32_t shape_offset() const { return energy_offset() + (stored.energy ? 1 : 0); }
  std::uint32_t row_size() const {
    return shape_offset() + 3 * static_cast<std::uint32_t>(spheres.size());
  }

  friend bool operator==(const GridSpec&, const GridSpec&) = default;
};

/// The unit of distance() (equality.hpp): the tolerance's. But "of a component" where a plug-in
/// compares several of them itself: there distance() is a difference of one, and has its unit.
std::string distance_unit(const GridSpec& spec);

/// Says in words what differs first between two descriptions, empty when nothing does:
/// "spacing 0.05 and 0.1".
std::string difference(const GridSpec& a, const GridSpec& b);

}  // namespace hapgrid
