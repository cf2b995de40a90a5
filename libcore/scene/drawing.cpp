#include "libcore/scene/drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <string_view>

#include "libcore/grid/vec3.hpp"
#include "libcore/scene/legend.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kMostSpheres = 4096;
constexpr float kNever = 1e6F;
constexpr float kPart = 0.6F;   // of the sum of two radii
constexpr float kNear = 1.25F;  // of the sum of two covalent radii

/// Half of the distance below which two spheres are joined: first two atoms, then two others.
std::array<float, 2> reach_of(const Scene& scene, const Sphere& sphere) {
  static const std::map<std::string_view, float> covalent_radii{
      {"H", 0.31F},  {"B", 0.84F},  {"C", 0.76F},  {"N", 0.71F},  {"O", 0.66F},
      {"F", 0.57F},  {"P", 1.07F},  {"S", 1.05F},  {"I", 1.39F},  {"Si", 1.11F},
      {"Cl", 1.02F}, {"Ge", 1.20F}, {"As", 1.19F}, {"Se", 1.20F}, {"Br", 1.20F}};  // angstrom
  const auto found = covalent_radii.find(sphere.label);
  if (scene.length_unit == "angstrom" && found != covalent_radii.end())
    return {kNear * found->second, -kNever};
  return {-kNever, kPart * sphere.radius};
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> find_bonds(const Scene& scene, const Frame& frame) {
  std::vector<std::array<std::uint32_t, 2>> bonds;
  const auto count = static_cast<std::uint32_t>(scene.spheres.size());
  if (count > kMostSpheres) return bonds;
  std::vector<std::array<float, 2>> reaches;
  for (const Sphere& sphere : scene.spheres) reaches.push_back(reach_of(scene, sphere));
  for (std::uint32_t i = 0; i < count; ++i) {
    const float* a = frame.centres.data() + 3 * i;
    for (std::uint32_t j = i + 1; j < count; ++j) {
      const float* b = frame.centres.data() + 3 * j;
      const float reach = std::max(reaches[i][0] + reaches[j][0], reaches[i][1] + reaches[j][1]);
      float square = 0;
      for (int k = 0; k < 3; ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
      if (reach > 0 && square < reach * reach)
        bonds.push_back({i, j});  // false for what is not finite
    }
  }
  return bonds;
}

namespace {

constexpr double kAround = 1.06;  // around what fills a picture

Vec3 along(const Vec3& a, const Vec3& b, double t) { return a + t * (b - a); }

/// Model to rays: x right, y down, z towards the viewer, all in distances of neighbouring rays.
struct Projection {
  Vec3 right, up, near;  // the picture's axes
  Vec3 centre;           // in these
  double scale;
  double x0;
  double y0;

  Projection(const Camera& camera, const RenderOptions& options)
      : right(camera.right()),
        up(camera.up()),
        near(camera.near()),
        centre(in_axes(camera.centre)),
        scale(options.supersampling * std::min(options.width, options.height) /
              (2 * camera.half_width)),
        x0(0.5 * options.supersampling * options.width),
        y0(0.5 * options.supersampling * options.height) {}

  Vec3 in_axes(const Vec3& v) const { return {dot(right, v), dot(up, v), dot(near, v)}; }
  Vec3 operator()(const Vec3& v) const {
    const Vec3 p = in_axes(v);
    return {x0 + scale * (p[0] - centre[0]), y0 - scale * (p[1] - centre[1]),
            scale * (p[2] - centre[2])};
  }
};

double size_of(const Box& box) {
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

/// The force as an arrow that begins outside the HIP: a shaft and a head, as many balls that stand
/// close together. Those of the head are half balls, so that its back is flat.
void add_arrow(const Scene& scene, const Frame& frame, const Projection& project,
               std::vector<Ball>& balls) {
  const auto [length, shaft, wide, head] = arrow_sizes(scene, frame);
  if (!(length > 0)) return;
  const Vec3 way = (1 / length_of(frame.force)) * frame.force;
  const Vec3 from = frame.position + hip_radius(scene) * way;
  const Vec3 seen = project(from + way) - project(from);  // of the length project.scale
  const Vec3 cut = (1 / project.scale) * seen;
  // Half a ray apart they look like one thing; the bound is for absurd lengths.
  const int steps = static_cast<int>(std::clamp(length * project.scale / 0.5, 8.0, 4000.0));
  for (int i = 0; i <= steps; ++i) {
    const double at = length * i / steps;
    const double left = length - at;  // to the tip
    const bool in_head = left < head;
    balls.push_back({project(from + at * way),
                     (in_head ? wide * left / head : shaft) * project.scale, kForceColour,
                     in_head ? cut : Vec3{0, 0, 0}});
  }
}

/// A ring around a place of the picture, in pixels.
void add_ring(const Vec3& middle, double radius, const Colour& colour, const RenderOptions& options,
              std::vector<Line>& lines) {
  constexpr int kSides = 40;
  const double rays = options.supersampling * options.letter_scale;
  const auto at = [&](int i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    return Vec3{middle[0] + radius * rays * std::cos(angle),
                middle[1] + radius * rays * std::sin(angle), 0};
  };
  for (int i = 0; i < kSides; ++i) lines.push_back({at(i), at(i + 1), kHandPixels * rays, colour});
}

/// The ring at the hand, and the thread by which the hand holds the HIP.
void add_hand(const Vec3& hand, const Vec3& hip, const RenderOptions& options,
              std::vector<Line>& lines) {
  add_ring(hand, kRingPixels, kHipColour, options, lines);
  const double rays = options.supersampling * options.letter_scale;
  const double away = std::hypot(hip[0] - hand[0], hip[1] - hand[1]);
  if (!(away > kRingPixels * rays) || !std::isfinite(away)) return;
  const Vec3 from = along(hand, hip, kRingPixels * rays / away);
  lines.push_back({{from[0], from[1], 0}, {hip[0], hip[1], 0}, kHandPixels * rays, kHipColour});
}

/// What the floor has of a ball that is somewhere above it.
void add_shadow(const Scene& scene, const Vec3& centre, double radius, const Projection& project,
                std::vector<Shadow>& shadows) {
  if (!(centre[2] > scene.box.origin[2])) return;
  const Vec3 at = project({centre[0], centre[1], scene.box.origin[2]});
  const double half = kShadowRadii * radius * project.scale;
  if (finite(at) && half > 0) shadows.push_back({{at[0], at[1]}, {half, half * project.near[2]}});
}

/// The floor, if it is seen from above, and how far the box and the balls reach in depth.
void add_depths(const Scene& scene, const Projection& project, Drawing& all) {
  const Vec3 from = project(corner(scene.box, 0));
  all.nearest = all.farthest = from[2];
  const auto see = [&](double z) {
    all.nearest = std::max(all.nearest, z);
    all.farthest = std::min(all.farthest, z);
  };
  for (int c = 1; c < 8; ++c) see(project(corner(scene.box, c))[2]);
  for (const Ball& ball : all.balls) see(ball.centre[2]);
  if (!(project.near[2] > 0)) return;
  const Vec3 right = project(corner(scene.box, 1)) - from,
             back = project(corner(scene.box, 2)) - from;
  all.floor = {{{from[0], from[1]}, {right[0], right[1]}, {back[0], back[1]}}};
}

/// As many balls that stand close together, each half in the colour of its end. part: of the
/// spheres' radii that is drawn.
void add_stick(const Scene& scene, const Frame& frame, const std::array<std::uint32_t, 2>& bond,
               double part, const Projection& project, std::vector<Ball>& balls) {
  const std::array ends{sphere_centre(frame, bond[0]), sphere_centre(frame, bond[1])};
  const double one = part * scene.spheres[bond[0]].radius,
               other = part * scene.spheres[bond[1]].radius;
  const double length =
      std::hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1], ends[1][2] - ends[0][2]);
  if (length < one + other) return;  // nothing of it is seen
  const double radius = kStickPart / kBallPart * std::min(one, other);
  // A 16th of a radius apart they look like one thing: the notches are a 2000th of it deep.
  const int steps = 1 + static_cast<int>(std::min(16 * length / radius, 4000.0));
  for (int i = 0; i <= steps; ++i)
    balls.push_back({project(along(ends[0], ends[1], static_cast<double>(i) / steps)),
                     radius * project.scale, scene.spheres[bond[2 * i > steps]].colour});
}

/// The torsions that have turned, each at the middle of its bond.
void name_turned(const Scene& scene, const Frame& frame, const Projection& project,
                 const RenderOptions& options, Drawing& all) {
  std::vector<std::pair<Vec3, std::string>> names;
  for (std::size_t i = 0; i < frame.turned.size(); ++i) {
    if (!(std::abs(frame.turned[i]) >= kTurned)) continue;
    const Torsion& torsion = scene.torsions[i];
    const Vec3 middle = project(along(sphere_centre(frame, torsion.spheres[1]),
                                      sphere_centre(frame, torsion.spheres[2]), 0.5));
    if (finite(middle)) names.emplace_back(middle, torsion_text(torsion, frame.angles[i]));
  }
  add_names(all, std::move(names), options);
}

}  // namespace

double hip_radius(const Scene& scene) {
  return scene.hip_radius > 0 ? scene.hip_radius : size_of(scene.box) / 40;
}

std::array<double, 4> arrow_sizes(const Scene& scene, const Frame& frame) {
  const double newton = scene.largest_force > 0 ? 0.25 / scene.largest_force : 1.0 / 6;
  const double length = newton * size_of(scene.box) * length_of(frame.force);
  if (!(length > 0) || !std::isfinite(length)) return {};
  const double hip = hip_radius(scene);
  return {length, std::min(0.035 * length, 0.2 * hip), std::min(0.12 * length, 0.6 * hip),
          std::min(0.35 * length, 1.7 * hip)};
}

void add_to_way(const Scene& scene, const Frame& frame, RenderOptions& options) {
  if (!finite(frame.position)) return;
  const double length = arrow_sizes(scene, frame)[0];
  const double part = length > 0 ? length / length_of(frame.force) : 0;
  if (!options.way) options.way = {frame.position, frame.position};
  for (const Vec3& place : {frame.position, frame.position + part * frame.force})
    for (int a = 0; a < 3; ++a) {
      auto& [low, high] = *options.way;
      low[a] = std::min(low[a], place[a]);
      high[a] = std::max(high[a], place[a]);
    }
}

namespace {
double radians(double degrees) { return degrees * std::numbers::pi / 180; }
}  // namespace

Vec3 Camera::right() const {
  const double a = radians(azimuth_degrees);
  return {std::cos(a), std::sin(a), 0};
}

Vec3 Camera::up() const {
  const double a = radians(azimuth_degrees), e = radians(elevation_degrees);
  return {-std::sin(a) * std::sin(e), std::cos(a) * std::sin(e), std::cos(e)};
}

Vec3 Camera::near() const {
  const double a = radians(azimuth_degrees), e = radians(elevation_degrees);
  return {std::sin(a) * std::cos(e), -std::cos(a) * std::cos(e), std::sin(e)};
}

std::array<double, 3> fit_extent(const Scene& scene, const Frame& frame,
                                 const RenderOptions& options, Camera& camera) {
  camera = {options.azimuth_degrees, options.elevation_degrees};
  const Vec3 right = camera.right(), up = camera.up(), near = camera.near();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low{kInfinity, kInfinity, kInfinity};
  Vec3 high{-kInfinity, -kInfinity, -kInfinity};
  const auto see = [&](const Vec3& v, double radius) {
    if (!finite(v)) return;
    const Vec3 p{dot(right, v), dot(up, v), dot(near, v)};
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a] - radius);
      high[a] = std::max(high[a], p[a] + radius);
    }
  };
  for (std::size_t i = 0; i < scene.spheres.size(); ++i)
    see(sphere_centre(frame, i), scene.spheres[i].radius);
  const double rightmost = high[0];
  const double room = options.hip ? hip_radius(scene) : 0;
  for (int c = 0; c < 8; ++c) {
    Vec3 at = corner(scene.box, c);
    if (options.way)
      for (int a = 0; a < 3; ++a) at[a] = (*options.way)[c >> a & 1][a];
    see(at, room);
  }
  const Vec3 middle{0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])};
  camera.centre = middle[0] * right + middle[1] * up + middle[2] * near;
  return {0.5 * kAround * (high[0] - low[0]), 0.5 * kAround * (high[1] - low[1]),
          std::max(0.0, kAround * (rightmost - middle[0]))};
}

Camera fit_camera(const Scene& scene, const Frame& frame, const RenderOptions& options) {
  Camera camera;
  const auto [right, up, spheres] = fit_extent(scene, frame, options, camera);
  const bool named = options.legend && std::min(options.width, options.height) >= kSmallest;
  const double beside =
      named ? std::min(options.letter_scale * names_width(scene), kNamesPart * options.width) : 0;
  const double unit = std::max(
      {right / options.width, up / options.height, spheres / (options.width - 2 * beside)});
  camera.half_width = unit * std::min(options.width, options.height);
  if (!(camera.half_width > 0)) camera.half_width = 1;
  return camera;
}

namespace {

/// The spheres that touch the HIP; none where it is inside of one, as of an atom that it holds.
void add_touched(const Scene& scene, const Frame& frame, double hip_radius,
                 const Projection& project, std::vector<Ball>& touched) {
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const Sphere& sphere = scene.spheres[i];
    const Vec3 centre = sphere_centre(frame, i);
    const double away = length_of(centre - frame.position);
    if (away < sphere.radius) return touched.clear();
    if (away < kTouch * (sphere.radius + hip_radius))
      touched.push_back({project(centre), sphere.radius * project.scale, sphere.colour});
  }
}

}  // namespace

Drawing draw(const Scene& scene, const Frame& frame, const Camera& camera,
             const RenderOptions& options) {
  const Projection project(camera, options);
  Drawing all;
  const double part = options.sticks ? kBallPart : 1;
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const Vec3 centre = sphere_centre(frame, i);
    if (!finite(centre)) continue;
    const double radius = part * scene.spheres[i].radius;
    all.balls.push_back({project(centre), radius * project.scale, scene.spheres[i].colour});
    if (options.box) add_shadow(scene, centre, radius, project, all.shadows);
  }
  all.spheres = all.balls.size();
  if (options.box) add_depths(scene, project, all);
  for (const auto& bond : find_bonds(scene, frame))
    add_stick(scene, frame, bond, part, project, all.balls);
  if (options.box)
    for (int c = 0; c < 8; ++c)
      for (int axis = 0; axis < 3; ++axis)
        if ((c >> axis & 1) == 0)
          all.lines.push_back(
              {project(corner(scene.box, c)), project(corner(scene.box, c | 1 << axis)),
               kLinePixels * options.supersampling * options.letter_scale, kBoxColour});
  if (options.hip && finite(frame.position)) {
    const Vec3 hip = project(frame.position);
    const double radius = hip_radius(scene);
    add_arrow(scene, frame, project, all.balls);
    all.translucent.push_back({hip, radius * project.scale, kHipColour});
    if (options.sticks && length_of(frame.force) > 0)
      add_touched(scene, frame, radius, project, all.touched);
    if (options.box) add_shadow(scene, frame.position, radius, project, all.shadows);
    if (finite(frame.hand)) add_hand(project(frame.hand), hip, options, all.overlay);
    const double pixels = radius * project.scale / options.supersampling / options.letter_scale;
    if (options.flash)
      for (const double wider : kFlashPixels)
        add_ring(hip, pixels + wider, kSnapColour, options, all.overlay);
  }
  if (options.legend && std::min(options.width, options.height) >= kSmallest) {
    name_turned(scene, frame, project, options, all);
    add_legend(all, scene, camera, options);
  }
  return all;
}

}  // namespace hapgrid
