#include "libcore/scene/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libcore/grid/vec3.hpp"
#include "libcore/scene/bonds.hpp"
#include "libcore/scene/legend.hpp"
#include "libcore/scene/torsion.hpp"

namespace hapgrid {

namespace {

constexpr Colour kBoxColour{0.62F, 0.65F, 0.7F};
constexpr Colour kHipColour{0.15F, 0.35F, 0.95F};
constexpr Colour kForceColour{0.85F, 0.1F, 0.1F};
constexpr double kLinePixels = 0.6;  // half the width of the box's edges
constexpr double kAround = 1.06;     // around what fills a picture

Vec3 along(const Vec3& a, const Vec3& b, double t) { return a + t * (b - a); }

/// Model to rays: x right, y down, z towards the viewer, all in distances of neighbouring rays.
struct Projection {
  PictureAxes axes;
  Vec3 centre;  // in the picture's axes
  double scale;
  double x0;
  double y0;

  Projection(const Camera& camera, const RenderOptions& options)
      : axes(camera),
        centre(axes(camera.centre)),
        scale(options.supersampling * std::min(options.width, options.height) /
              (2 * camera.half_width)),
        x0(0.5 * options.supersampling * options.width),
        y0(0.5 * options.supersampling * options.height) {}

  Vec3 operator()(const Vec3& v) const {
    const Vec3 p = axes(v);
    return {x0 + scale * (p[0] - centre[0]), y0 - scale * (p[1] - centre[1]),
            scale * (p[2] - centre[2])};
  }
};

double longest_side(const Box& box) {
  const auto most = *std::max_element(box.counts.begin(), box.counts.end());
  return box.spacing * std::max<double>(1, most - 1.0);
}

Vec3 corner(const Box& box, int c) {
  return box.position(GridCoordinates{c & 1 ? box.counts[0] - 1 : 0, c & 2 ? box.counts[1] - 1 : 0,
                                      c & 4 ? box.counts[2] - 1 : 0});
}

Vec3 sphere_centre(const Frame& frame, std::size_t i) {
  return {frame.centres[3 * i], frame.centres[3 * i + 1], frame.centres[3 * i + 2]};
}

// The arrow of the force, from the HIP.
Vec3 arrow_tip(const Scene& scene, const Frame& frame, const RenderOptions& options) {
  return frame.position + newton_length(scene, options) * frame.force;
}
double shaft_radius(const Scene& scene, const RenderOptions& options) {
  return hip_radius(scene, options) / 5;
}

/// A shaft and a head, as many balls that stand close together.
void add_arrow(const Vec3& from, const Vec3& to, double shaft, const Projection& project,
               std::vector<Ball>& balls) {
  const double length = std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  if (!(length > 0) || !std::isfinite(length)) return;
  const double head = std::min(6 * shaft, length);
  // Half a ray apart they look like one thing; the bound is for absurd lengths.
  const int steps = static_cast<int>(std::clamp(length * project.scale / 0.5, 8.0, 4000.0));
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const double left = length * (1 - t);  // to the tip
    const double radius = left < head ? 2.5 * shaft * left / head : shaft;
    balls.push_back({project(along(from, to, t)), radius * project.scale, kForceColour});
  }
}

/// As many balls that stand close together, each half in the colour of its end.
void add_stick(const Scene& scene, const Frame& frame, const std::array<std::uint32_t, 2>& bond,
               const Projection& project, std::vector<Ball>& balls) {
  const std::array ends{sphere_centre(frame, bond[0]), sphere_centre(frame, bond[1])};
  const double radius =
      kStickPart * std::min(scene.spheres[bond[0]].radius, scene.spheres[bond[1]].radius);
  const double length =
      std::hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1], ends[1][2] - ends[0][2]);
  // A 16th of a radius apart they look like one thing: the notches are a 2000th of it deep.
  const int steps = 1 + static_cast<int>(std::min(16 * length / radius, 4000.0));
  for (int i = 0; i <= steps; ++i)
    balls.push_back({project(along(ends[0], ends[1], static_cast<double>(i) / steps)),
                     radius * project.scale, scene.spheres[bond[2 * i > steps]].colour});
}

/// The torsions that have turned, each at the middle of its bond.
void name_turned(const Scene& scene, const Frame& frame, const Projection& project,
                 const RenderOptions& options, Drawing& all) {
  for (std::size_t i = 0; i < frame.turned.size(); ++i) {
    if (!(std::abs(frame.turned[i]) >= kTurned)) continue;
    const Torsion& torsion = scene.torsions[i];
    const Vec3 middle = project(along(sphere_centre(frame, torsion.spheres[1]),
                                      sphere_centre(frame, torsion.spheres[2]), 0.5));
    if (finite(middle))
      add_plate(all, turned_text(torsion, frame.turned[i]), middle[0], middle[1], options);
  }
}

}  // namespace

double hip_radius(const Scene& scene, const RenderOptions& options) {
  if (options.hip_radius > 0) return options.hip_radius;
  return scene.hip_radius > 0 ? scene.hip_radius : longest_side(scene.box) / 40;
}

double newton_length(const Scene& scene, const RenderOptions& options) {
  return options.arrow > 0 ? options.arrow : longest_side(scene.box) / 6;
}

PictureAxes::PictureAxes(const Camera& camera) {
  const double a = camera.azimuth_degrees * std::numbers::pi / 180;
  const double e = camera.elevation_degrees * std::numbers::pi / 180;
  right = {std::cos(a), std::sin(a), 0};
  near = {std::sin(a) * std::cos(e), -std::cos(a) * std::cos(e), std::sin(e)};
  up = {-std::sin(a) * std::sin(e), std::cos(a) * std::sin(e), std::cos(e)};
}

std::array<double, 2> fit_extent(const Scene& scene, const Frame& frame,
                                 const RenderOptions& options, Camera& camera) {
  const PictureAxes axes(camera);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low{kInfinity, kInfinity, kInfinity};
  Vec3 high{-kInfinity, -kInfinity, -kInfinity};
  const auto see = [&](const Vec3& v, double radius) {
    if (!finite(v)) return;
    const Vec3 p = axes(v);
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a] - radius);
      high[a] = std::max(high[a], p[a] + radius);
    }
  };
  for (std::size_t i = 0; i < scene.spheres.size(); ++i)
    see(sphere_centre(frame, i), scene.spheres[i].radius);
  const double room = options.hip ? hip_radius(scene, options) : 0;
  for (int c = 0; c < 8; ++c) see(corner(scene.box, c), room);
  const Vec3 middle{0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])};
  camera.centre = middle[0] * axes.right + middle[1] * axes.up + middle[2] * axes.near;
  return {0.5 * kAround * (high[0] - low[0]), 0.5 * kAround * (high[1] - low[1])};
}

Camera fit_camera(const Scene& scene, const Frame& frame, const RenderOptions& options,
                  double azimuth_degrees, double elevation_degrees) {
  Camera camera{azimuth_degrees, elevation_degrees, {0, 0, 0}, 1};
  const auto [right, up] = fit_extent(scene, frame, options, camera);
  const double nearer = std::min(options.width, options.height);
  camera.half_width = std::max(right * nearer / options.width, up * nearer / options.height);
  if (!(camera.half_width > 0)) camera.half_width = 1;
  return camera;
}

Drawing draw(const Scene& scene, const Frame& frame, const Camera& camera,
             const RenderOptions& options) {
  const Projection project(camera, options);
  Drawing all;
  const double part = options.sticks ? kBallPart : 1;
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const Vec3 centre = sphere_centre(frame, i);
    if (!finite(centre)) continue;
    all.balls.push_back(
        {project(centre), part * scene.spheres[i].radius * project.scale, scene.spheres[i].colour});
  }
  if (options.sticks)
    for (const auto& bond : find_bonds(scene, frame))
      add_stick(scene, frame, bond, project, all.balls);
  if (options.box)
    for (int c = 0; c < 8; ++c)
      for (int axis = 0; axis < 3; ++axis)
        if ((c >> axis & 1) == 0)
          all.lines.push_back({project(corner(scene.box, c)),
                               project(corner(scene.box, c | 1 << axis)),
                               kLinePixels * options.supersampling, kBoxColour});
  if (options.hip && finite(frame.position)) {
    add_arrow(frame.position, arrow_tip(scene, frame, options), shaft_radius(scene, options),
              project, all.balls);
    all.translucent.push_back(
        {project(frame.position), hip_radius(scene, options) * project.scale, kHipColour});
  }
  if (options.letters) name_turned(scene, frame, project, options, all);
  if (options.legend) add_legend(all, scene, camera, options);
  return all;
}

}  // namespace hapgrid
