// The stream that viewers get of a running play (schemas/frame.capnp): a scene once, and frames.
// Lengths and positions are in the model's unit of length.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libcore/grid/spec.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

/// Frames a second of play's time: an eye takes so many for motion (Sect. 2.4).
inline constexpr int kFramesPerSecond = 25;
/// Frames a second in real time: the hand and what it sees are a screen's picture apart.
inline constexpr int kLiveFramesPerSecond = 60;

/// The facts that are the same in all frames.
struct Scene {
  std::string model;
  std::string length_unit;  ///< for people; may be empty
  std::string energy_unit;  ///< for people; may be empty
  Box box;
  std::uint32_t state_size = 1;
  double hip_radius = 0;  ///< of the ball that the HIP moves; 0 if it is unknown
  std::vector<Sphere> spheres;
  std::vector<Torsion> torsions;  ///< of the spheres, which viewers follow
  std::string keys;               ///< for people: what the keys do that play reads; may be empty
  double largest_force = 0;       ///< newtons that are sent at most in this grid; 0 if unknown
  friend bool operator==(const Scene&, const Scene&) = default;
};

/// One tick.
struct Frame {
  std::uint64_t tick = 0;
  double time_s = 0;
  Vec3 hip{};               ///< as the device gave it; may be outside the box or not finite
  Vec3 position{};          ///< the HIP held in the box, to which state, energy and force belong
  Vec3 hand = kNowhere;     ///< that pulls the HIP by a spring; NaN without one
  Vec3 force{};             ///< newtons, as sent
  std::uint64_t jumps = 0;  ///< ticks in which the state jumped, because it started or snapped
  std::vector<double> row;  ///< the state; then the grid's stored values, which no stream has
  // What takes too long to compute for the haptic loop:
  double energy = std::numeric_limits<double>::quiet_NaN();  ///< NaN if the model has none
  double own_energy = energy;  ///< of the model by itself, without the HIP; NaN as well
  std::vector<float> centres;  ///< of the spheres, x y z by sphere
  /// Of each of the scene's torsions the angle, in degrees in [-180, 180] (torsion_degrees()), and
  /// by how many of (-180, 180] it has turned since the first frame that the reader got; NaN if it
  /// is no angle.
  std::vector<double> angles, turned;
};

// The angle of four spheres.

/// Degrees in [-180, 180], positive clockwise when one looks from the second sphere to the third
/// (IUPAC); NaN where three of the spheres stand on a line or a place is not finite.
/// @param centres of all spheres, x y z by sphere
double torsion_degrees(const Torsion& torsion, std::span<const float> centres);

/// By how many degrees an angle has turned, in (-180, 180].
inline double turned_degrees(double first, double now) {
  return -std::remainder(first - now, 360);  // 180, never -180
}

/// Pictures name a torsion that has turned by so many degrees or more.
inline constexpr double kTurned = 10;

/// The name of a torsion, and its angle: "psi +67°".
std::string torsion_text(const Torsion& torsion, double degrees);

}  // namespace hapgrid
