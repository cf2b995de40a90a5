#include "libcore/scene/render.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

constexpr int kBandRows = 32;  // pixels; the memory for rays is that of a band

/// Light from the upper left and the viewer's side; darker towards the rim, which sets spheres of
/// one colour apart. `n` is the normal, x right, y down, z near.
Colour shade(const Colour& colour, const Vec3& n) {
  static constexpr Vec3 kLight{-0.4243, -0.5657, 0.7071};
  static constexpr Vec3 kHalf{-0.2297, -0.3062, 0.9239};  // between the light and the viewer
  const double diffuse = std::max(0.0, dot(n, kLight));
  // To the power of 40, which std::pow() takes as long for as for all the rest.
  const double half = std::max(0.0, dot(n, kHalf));
  const double half2 = half * half;
  const double half8 = half2 * half2 * half2 * half2;
  const double shine = 0.25 * half8 * (half8 * half8) * (half8 * half8);
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

  /// @param hidden how much of it is seen where something stands before it.
  void draw(const Ball& ball, float opacity, float hidden = 0) {
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
        const bool behind = z + dz <= depth_[i];
        const float part = behind ? hidden : opacity;
        if (part == 0) continue;
        const Colour lit = shade(ball.colour, {dx / r, dy / r, dz / r});
        for (int c = 0; c < 3; ++c) colour_[i][c] = part * lit[c] + (1 - part) * colour_[i][c];
        if (!behind) depth_[i] = z + dz;
      }
    }
  }

  /// @param over whether it is drawn over whatever is there.
  void draw(const Line& line, bool over = false) {
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
        if (z <= depth_[i] && !over) continue;
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

Image render(const Scene& scene, const Frame& frame, const Camera& camera,
             const RenderOptions& options) {
  const Drawing all = draw(scene, frame, camera, options);
  const int n = options.supersampling;
  Image image{options.width, options.height, {}};
  image.pixels.reserve(static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
  for (int first = 0; first < image.height; first += kBandRows) {
    const int rows = std::min(kBandRows, image.height - first);
    Band band(n * image.width, n * first, n * rows);
    for (const Line& line : all.lines) band.draw(line);
    for (const Ball& ball : all.balls) band.draw(ball, 1);
    for (const Ball& ball : all.translucent) band.draw(ball, kHipOpacity, kHiddenOpacity);
    for (const Line& line : all.overlay) band.draw(line, /*over=*/true);
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
