#include "libcore/scene/render.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hapgrid {

namespace {

using Colour = std::array<float, 3>;

constexpr Colour kBackground{1, 1, 1};
constexpr Colour kBoxColour{0.62F, 0.65F, 0.7F};
constexpr Colour kHipColour{0.15F, 0.35F, 0.95F};
constexpr Colour kForceColour{0.85F, 0.1F, 0.1F};
constexpr float kHipOpacity = 0.6F;
constexpr double kLinePixels = 0.6;  // half the width of the box's edges
constexpr int kBandRows = 32;        // pixels; the memory for rays is that of a band

double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 along(const Vec3& a, const Vec3& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}
bool finite(const Vec3& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/// The picture's axes in the model's space: to the right, up, towards the viewer.
struct Axes {
  Vec3 right;
  Vec3 up;
  Vec3 near;

  explicit Axes(const Camera& camera) {
    const double a = camera.azimuth_degrees * std::numbers::pi / 180;
    const double e = camera.elevation_degrees * std::numbers::pi / 180;
    right = {std::cos(a), std::sin(a), 0};
    near = {std::sin(a) * std::cos(e), -std::cos(a) * std::cos(e), std::sin(e)};
    up = {-std::sin(a) * std::sin(e), std::cos(a) * std::sin(e), std::cos(e)};
  }
  Vec3 operator()(const Vec3& v) const { return {dot(right, v), dot(up, v), dot(near, v)}; }
};

/// Model to rays: x right, y down, z towards the viewer, all in distances of neighbouring rays.
struct Projection {
  Axes axes;
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

struct Ball {
  Vec3 centre;  // in rays
  double radius;
  Colour colour;
};

struct Line {
  Vec3 from;  // in rays
  Vec3 to;
  double half_width;
  Colour colour;
};

/// Everything that is drawn, in rays.
struct Primitives {
  std::vector<Ball> balls;
  std::vector<Line> lines;
  std::vector<Ball> translucent;
};

double longest_side(const Box& box) {
  const auto most = *std::max_element(box.counts.begin(), box.counts.end());
  return box.spacing * std::max<double>(1, most - 1.0);
}

double hip_radius(const Scene& scene, const RenderOptions& options) {
  if (options.hip_radius > 0) return options.hip_radius;
  return scene.hip_radius > 0 ? scene.hip_radius : longest_side(scene.box) / 40;
}

Vec3 corner(const Box& box, int c) {
  return box.position(GridCoordinates{c & 1 ? box.counts[0] - 1 : 0, c & 2 ? box.counts[1] - 1 : 0,
                                      c & 4 ? box.counts[2] - 1 : 0});
}

struct Arrow {
  Vec3 from;
  Vec3 to;
  double radius;  // of the shaft
};

Arrow arrow(const Scene& scene, const Frame& frame, const RenderOptions& options) {
  const double newton = options.arrow > 0 ? options.arrow : longest_side(scene.box) / 6;
  const Vec3& x = frame.position;
  const Vec3& f = frame.force;
  return {x,
          {x[0] + newton * f[0], x[1] + newton * f[1], x[2] + newton * f[2]},
          hip_radius(scene, options) / 5};
}

/// A shaft and a head, as many balls that stand close together.
void add_arrow(const Arrow& a, const Projection& project, std::vector<Ball>& balls) {
  const double length = std::hypot(a.to[0] - a.from[0], a.to[1] - a.from[1], a.to[2] - a.from[2]);
  if (!(length > 0) || !std::isfinite(length)) return;
  const double head = std::min(6 * a.radius, length);
  // Half a ray apart they look like one thing; the bound is for absurd lengths.
  const int steps = static_cast<int>(std::clamp(length * project.scale / 0.5, 8.0, 4000.0));
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const double left = length * (1 - t);  // to the tip
    const double radius = left < head ? 2.5 * a.radius * left / head : a.radius;
    balls.push_back({project(along(a.from, a.to, t)), radius * project.scale, kForceColour});
  }
}

Primitives gather(const Scene& scene, const Frame& frame, const Projection& project,
                  const RenderOptions& options) {
  Primitives all;
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const float* c = frame.centres.data() + 3 * i;
    const Vec3 centre{c[0], c[1], c[2]};
    if (!finite(centre)) continue;
    all.balls.push_back(
        {project(centre), scene.spheres[i].radius * project.scale, scene.spheres[i].colour});
  }
  if (options.box)
    for (int c = 0; c < 8; ++c)
      for (int axis = 0; axis < 3; ++axis)
        if ((c >> axis & 1) == 0)
          all.lines.push_back({project(corner(scene.box, c)),
                               project(corner(scene.box, c | 1 << axis)),
                               kLinePixels * options.supersampling, kBoxColour});
  if (options.hip && finite(frame.position)) {
    add_arrow(arrow(scene, frame, options), project, all.balls);
    all.translucent.push_back(
        {project(frame.position), hip_radius(scene, options) * project.scale, kHipColour});
  }
  return all;
}

/// Light from the upper left and the viewer's side; darker towards the rim, which sets spheres of
/// one colour apart. `n` is the normal, x right, y down, z near.
Colour shade(const Colour& colour, const Vec3& n) {
  static constexpr Vec3 kLight{-0.4243, -0.5657, 0.7071};
  static constexpr Vec3 kHalf{-0.2297, -0.3062, 0.9239};  // between the light and the viewer
  const double diffuse = std::max(0.0, dot(n, kLight));
  const double shine = 0.25 * std::pow(std::max(0.0, dot(n, kHalf)), 40);
  const double rim = std::min(1.0, 0.45 + 1.6 * n[2]);
  Colour lit;
  for (int i = 0; i < 3; ++i)
    lit[i] = static_cast<float>(
        std::min(1.0, (0.4 + 0.6 * diffuse) * rim * static_cast<double>(colour[i]) + shine));
  return lit;
}

/// A band of rows of rays.
class Band {
 public:
  Band(int width, int first, int rows)
      : width_(width),
        first_(first),
        rows_(rows),
        depth_(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows),
               -std::numeric_limits<double>::infinity()),
        colour_(depth_.size(), kBackground) {}

  const Colour& at(int x, int y) const { return colour_[index(x, y)]; }

  void draw(const Ball& ball, float opacity) {
    const auto [x, y, z] = ball.centre;
    const double r = ball.radius;
    const auto [top, bottom] = span(y - r, y + r, first_, first_ + rows_);
    for (int row = top; row < bottom; ++row) {
      const double dy = row + 0.5 - y;
      const double half = std::sqrt(std::max(0.0, r * r - dy * dy));
      const auto [left, right] = span(x - half, x + half, 0, width_);
      for (int column = left; column < right; ++column) {
        const double dx = column + 0.5 - x;
        const double dz = std::sqrt(std::max(0.0, r * r - dx * dx - dy * dy));
        const std::size_t i = index(column, row);
        if (z + dz <= depth_[i]) continue;
        const Colour lit = shade(ball.colour, {dx / r, dy / r, dz / r});
        for (int c = 0; c < 3; ++c)
          colour_[i][c] = opacity * lit[c] + (1 - opacity) * colour_[i][c];
        depth_[i] = z + dz;
      }
    }
  }

  void draw(const Line& line) {
    const Vec3& a = line.from;
    const Vec3& b = line.to;
    const double w = line.half_width;
    const double dx = b[0] - a[0];
    const double dy = b[1] - a[1];
    const double length2 = dx * dx + dy * dy;
    const auto [top, bottom] =
        span(std::min(a[1], b[1]) - w, std::max(a[1], b[1]) + w, first_, first_ + rows_);
    for (int row = top; row < bottom; ++row) {
      // The part of the line that is nearer than w to this row bounds the columns.
      double t0 = 0, t1 = 1;
      if (dy != 0) {
        t0 = (row + 0.5 - w - a[1]) / dy;
        t1 = (row + 0.5 + w - a[1]) / dy;
        if (t0 > t1) std::swap(t0, t1);
        t0 = std::clamp(t0, 0.0, 1.0);
        t1 = std::clamp(t1, 0.0, 1.0);
      }
      const double x0 = a[0] + t0 * dx;
      const double x1 = a[0] + t1 * dx;
      const auto [left, right] = span(std::min(x0, x1) - w, std::max(x0, x1) + w, 0, width_);
      for (int column = left; column < right; ++column) {
        const double px = column + 0.5 - a[0];
        const double py = row + 0.5 - a[1];
        const double t = length2 > 0 ? std::clamp((px * dx + py * dy) / length2, 0.0, 1.0) : 0.0;
        if (std::hypot(px - t * dx, py - t * dy) > w) continue;
        const double z = a[2] + t * (b[2] - a[2]);
        const std::size_t i = index(column, row);
        if (z <= depth_[i]) continue;
        depth_[i] = z;
        colour_[i] = line.colour;
      }
    }
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - first_) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  /// The rays i, low <= i < high, whose middle i + 1/2 is in [from, to]; none for NaN.
  static std::pair<int, int> span(double from, double to, int low, int high) {
    if (!(from <= to)) return {low, low};
    const double first = std::ceil(from - 0.5);
    const double last = std::floor(to - 0.5) + 1;
    return {static_cast<int>(std::clamp<double>(first, low, high)),
            static_cast<int>(std::clamp<double>(last, low, high))};
  }

  int width_;
  int first_;
  int rows_;
  std::vector<double> depth_;
  std::vector<Colour> colour_;
};

}  // namespace

Camera fit_camera(const Scene& scene, const Frame& frame, const RenderOptions& options,
                  double azimuth_degrees, double elevation_degrees) {
  Camera camera{azimuth_degrees, elevation_degrees, {0, 0, 0}, 1};
  const Axes axes(camera);
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
  if (options.box)
    for (int c = 0; c < 8; ++c) see(corner(scene.box, c), 0);
  for (std::size_t i = 0; i < scene.spheres.size(); ++i)
    see({frame.centres[3 * i], frame.centres[3 * i + 1], frame.centres[3 * i + 2]},
        scene.spheres[i].radius);
  if (options.hip) {
    const Arrow force = arrow(scene, frame, options);
    see(frame.position, hip_radius(scene, options));
    see(force.to, 2.5 * force.radius);
  }
  if (!(low[0] <= high[0])) return camera;  // nothing to see
  const double margin = 1.06;
  const double nearer = std::min(options.width, options.height);
  camera.half_width = 0.5 * margin *
                      std::max((high[0] - low[0]) * nearer / options.width,
                               (high[1] - low[1]) * nearer / options.height);
  if (!(camera.half_width > 0)) camera.half_width = 1;
  const Vec3 middle{0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])};
  for (int a = 0; a < 3; ++a)
    camera.centre[a] =
        middle[0] * axes.right[a] + middle[1] * axes.up[a] + middle[2] * axes.near[a];
  return camera;
}

Image render(const Scene& scene, const Frame& frame, const Camera& camera,
             const RenderOptions& options) {
  const Projection project(camera, options);
  const Primitives all = gather(scene, frame, project, options);
  const int n = options.supersampling;
  Image image{options.width, options.height, {}};
  image.pixels.reserve(static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
  for (int first = 0; first < image.height; first += kBandRows) {
    const int rows = std::min(kBandRows, image.height - first);
    Band band(n * image.width, n * first, n * rows);
    for (const Line& line : all.lines) band.draw(line);
    for (const Ball& ball : all.balls) band.draw(ball, 1);
    for (const Ball& ball : all.translucent) band.draw(ball, kHipOpacity);
    for (int y = first; y < first + rows; ++y)
      for (int x = 0; x < image.width; ++x) {
        Colour sum{};
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i)
            for (int c = 0; c < 3; ++c) sum[c] += band.at(n * x + i, n * y + j)[c];
        Rgb pixel;
        for (int c = 0; c < 3; ++c)
          pixel[c] = static_cast<std::uint8_t>(
              std::lround(255 * std::clamp(sum[c] / static_cast<float>(n * n), 0.0F, 1.0F)));
        image.pixels.push_back(pixel);
      }
  }
  return image;
}

}  // namespace hapgrid
