// The description of a grid, which each shard's header carries. Shards of one grid have the same.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "libcore/grid/box.hpp"
#include "libcore/grid/equality.hpp"

namespace hapgrid {

/// The value of a model's parameter, as [model.parameters] of a MODEL.toml has it.
/// Whole numbers are kept as doubles; one beyond 2^53 is refused when the MODEL.toml is read.
using ParameterValue =
    std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>>;

struct Parameter {
  std::string key;  ///< tables are flattened: "probe.radius"
  ParameterValue value;
  friend bool operator==(const Parameter&, const Parameter&) = default;
};

/// The largest state size: 2^20 doubles are 8 MiB. A larger one is a mistake or an attack.
inline constexpr std::uint32_t kMaxStateSize = 1u << 20;

/// What a grid keeps beside each state, because the haptic loop has no time to ask the model for it
/// (Sect. 2.2). The search computes it once, and play interpolates it.
struct Stored {
  bool force = false;
  bool energy = false;
  bool shape = false;
  friend bool operator==(const Stored&, const Stored&) = default;
};

/// The properties that a sphere of the model's shape has in every state.
struct Sphere {
  float radius = 0;                      ///< the model's unit of length
  std::array<float, 3> colour{0, 0, 0};  ///< red, green, blue in [0, 1]
  std::string label;                     ///< an atom's is its element's symbol
  friend bool operator==(const Sphere&, const Sphere&) = default;
};
inline constexpr std::size_t kMaxLabelSize = 7;

/// A torsion that people watch: the angle between the planes through the first and the last three
/// of four spheres.
struct Torsion {
  std::array<std::uint32_t, 4> spheres{};
  std::string name;
  friend bool operator==(const Torsion&, const Torsion&) = default;
};
inline constexpr std::uint32_t kMaxTorsions = 4096;

/// The most spheres; viewers get them in each frame.
inline constexpr std::uint32_t kMaxSpheres = 1u << 20;

/// What a model says of itself, and a grid repeats in its header.
///
/// The numbers of a record are its row: the state, then what is stored with it in the order force
/// (3, newtons), energy (1), shape (x y z of each sphere, rounded to floats).
struct ModelDescription {
  std::uint32_t state_size = 1;  ///< n, the number of components of a state
  double tolerance = 0;          ///< the bound that the model's tolerance function applies
  std::string tolerance_unit;
  /// The tolerance function if the model is a process; a plug-in has its own. The periods apply to
  /// both.
  Equality equality;
  std::string length_unit;  ///< for people to read, as is the next one; may be empty
  std::string energy_unit;
  std::string version;     ///< of the model, in its own words; may be empty
  double force_scale = 0;  ///< newtons that one unit of energy per unit of length is; 0: unknown
  double hip_radius = 0;   ///< of the ball that pictures show at the HIP; 0 when there is none
  Stored stored;
  /// They show a state. A grid has none when it does not store the shape.
  std::vector<Sphere> spheres;

  std::uint32_t force_offset() const { return state_size; }
  std::uint32_t energy_offset() const { return force_offset() + (stored.force ? 3 : 0); }
  std::uint32_t shape_offset() const { return energy_offset() + (stored.energy ? 1 : 0); }
  std::uint32_t row_size() const {
    return shape_offset() + (stored.shape ? 3 * static_cast<std::uint32_t>(spheres.size()) : 0);
  }

  friend bool operator==(const ModelDescription&, const ModelDescription&) = default;
};

/// Everything about a grid that is known before its first record is computed.
struct GridSpec : ModelDescription {
  Box box;
  std::string model;                  ///< the name of the plug-in or process
  std::vector<Parameter> parameters;  ///< ascending by key
  std::uint32_t max_levels = 64;      ///< the most levels that a point may have, 1 .. kMaxLevels

  friend bool operator==(const GridSpec&, const GridSpec&) = default;
};

/// The unit of distance() (equality.hpp): the tolerance's. The norm of a plug-in that compares
/// several components is unknown. Then distance() is the largest difference of a component, and the
/// unit is "of a component".
std::string distance_unit(const GridSpec& spec);

/// The first difference in words, as in "tolerance 0.05 and 0.1"; empty when there is none. Spheres
/// are compared where both store the shape.
std::string difference(const ModelDescription& a, const ModelDescription& b);
std::string difference(const GridSpec& a, const GridSpec& b);

}  // namespace hapgrid
