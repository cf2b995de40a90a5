#include "libcore/scene/render.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/scene/letters.hpp"
#include "libcore/scene/light.hpp"

namespace hapgrid {

namespace {

constexpr int kBandRows = 32;  // pixels; the memory for rays is that of a band

using namespace light;

/// exp(-x) for x >= 0, nearly, by operations that every machine rounds alike.
double fading(double x) {
  double base = 1 / (1 + x / 16);
  for (int i = 0; i < 4; ++i) base *= base;
  return base;
}

/// For each sphere the others that darken it most.
using Occluders = std::vector<std::vector<Ball>>;

Occluders find_occluders(const Drawing& all) {
  Occluders found(all.spheres);
  if (all.spheres > kMostShaded) return found;
  for (std::size_t i = 0; i < all.spheres; ++i) {
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t k = 0; k < all.spheres; ++k) {
      const Ball& other = all.balls[k];
      const double away = length_of(other.centre - all.balls[i].centre);
      if (k != i && away > 0 && away < kReach * other.radius + all.balls[i].radius)
        near.emplace_back(-other.radius / away, k);
    }
    std::sort(near.begin(), near.end());
    if (near.size() > kMostOccluders) near.resize(kMostOccluders);
    for (const auto& [size, k] : near) found[i].push_back(all.balls[k]);
  }
  return found;
}

/// The part of the light that the neighbours leave to a point with this normal: what each covers of
/// the sky above the point has a closed form.
double open_light(const std::vector<Ball>& occluders, const Vec3& point, const Vec3& normal) {
  double sum = 0;
  for (const Ball& other : occluders) {
    const Vec3 way = other.centre - point;
    const double away2 = dot(way, way);
    const double size = std::min(1.0, other.radius * other.radius / away2) - 1 / (kReach * kReach);
    if (!(size > 0)) continue;
    const double above = std::max(0.0, 0.5 + 0.5 * dot(normal, way) / std::sqrt(away2));
    sum += above * std::sqrt(above) * size;
  }
  return std::clamp(kOpen * fading(kFading * sum), kLeastOpen, kMostOpen);
}

/// @param n the normal, x right, y down, z near. @param light see open_light()
/// @param fog the part of white
Colour shade(const Colour& colour, const Vec3& n, double light, double fog) {
  const double diffuse = std::max(0.0, dot(n, kFrom));
  // To the power of 40, which std::pow() takes as long for as for all the rest.
  const double half = std::max(0.0, dot(n, kHalfWay));
  const double half2 = half * half;
  const double half8 = half2 * half2 * half2 * half2;
  const double shine = kShine * half8 * (half8 * half8) * (half8 * half8);
  Colour lit;
  for (int i = 0; i < 3; ++i) {
    const double own = (kAmbient + kDiffuse * diffuse) * light * static_cast<double>(colour[i]);
    lit[i] = static_cast<float>((1 - fog) * std::min(1.0, own + shine) + fog);
  }
  return lit;
}

/// Where a ray meets a ball, from whose centre it passes at dx, dy: the depth above the centre and
/// the normal. @return whether it does
bool meet(const Ball& ball, double dx, double dy, double& dz, Vec3& normal) {
  const double r = ball.radius;
  dz = std::sqrt(std::max(0.0, r * r - dx * dx - dy * dy));
  normal = {dx / r, dy / r, dz / r};
  if (dot(ball.cut, normal) >= 0) return true;
  // The flat side of a half ball, if it faces the viewer.
  if (!(ball.cut[2] < 0)) return false;
  const double flat = -(dx * ball.cut[0] + dy * ball.cut[1]) / ball.cut[2];
  if (!(std::abs(flat) <= dz)) return false;
  dz = flat;
  normal = {-ball.cut[0], -ball.cut[1], -ball.cut[2]};
  return true;
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
        colour_(depth_.size(), kBackground),
        ball_(depth_.size(), -1) {}

  const Colour& at(int x, int y) const { return colour_[index(x, y)]; }

  /// The floor with its shadows, behind everything. Shadows that overlap run into one: each leaves
  /// its part of what the others leave.
  void draw_floor(const Drawing& all) {
    const auto& [from, right, back] = all.floor;
    const double area = right[0] * back[1] - right[1] * back[0];
    if (area == 0 || !std::isfinite(area)) return;
    for (const Shadow& shadow : all.shadows) draw_shadow(shadow);
    for (int row = first_; row < first_ + rows_; ++row)
      for (int column = 0; column < width_; ++column) {
        const double x = column + 0.5 - from[0], y = row + 0.5 - from[1];
        const double a = (x * back[1] - y * back[0]) / area;
        const double b = (right[0] * y - right[1] * x) / area;
        Colour& colour = colour_[index(column, row)];
        const double dark = kShadow * (1 - static_cast<double>(colour[0]));
        colour = kBackground;
        if (a >= 0 && a <= 1 && b >= 0 && b <= 1)
          colour.fill(static_cast<float>(kFloor * (1 - dark)));
      }
  }

  /// Takes the rays that meet the ball first; light() colours them.
  void draw(const Ball& ball, int number) {
    each_ray(ball, ball.radius, [&](std::size_t i, double dx, double dy) {
      double dz;
      Vec3 normal;
      if (!meet(ball, dx, dy, dz, normal) || ball.centre[2] + dz <= depth_[i]) return;
      depth_[i] = ball.centre[2] + dz;
      ball_[i] = number;
    });
  }

  /// A dark rim where what lies beside the ball is much deeper: a disc somewhat wider than the ball
  /// and behind its middle.
  void draw_outline(const Ball& ball, double wider, double fog) {
    const double z = ball.centre[2] - kOutlineDepth * ball.radius;
    Colour dark;
    for (int c = 0; c < 3; ++c)
      dark[c] =
          static_cast<float>((1 - fog) * kOutlineLight * static_cast<double>(ball.colour[c]) + fog);
    each_ray(ball, ball.radius + wider, [&](std::size_t i, double dx, double dy) {
      if (z <= depth_[i] || dot(ball.cut, {dx, dy, 0}) < 0) return;
      depth_[i] = z;
      colour_[i] = dark;
      ball_[i] = -1;
    });
  }

  /// Over what was lit. @param hidden how much of it is seen where something stands before it.
  void draw_translucent(const Ball& ball, float opacity, float hidden) {
    each_ray(ball, ball.radius, [&](std::size_t i, double dx, double dy) {
      double dz;
      Vec3 normal;
      meet(ball, dx, dy, dz, normal);
      const bool behind = ball.centre[2] + dz <= depth_[i];
      const float part = behind ? hidden : opacity;
      const Colour lit = shade(ball.colour, normal, 1, 0);
      for (int c = 0; c < 3; ++c) colour_[i][c] = part * lit[c] + (1 - part) * colour_[i][c];
    });
  }

  /// Colours the rays that balls have taken. Neighbours darken the rays of a pixel, which are
  /// `side` x `side`, alike.
  void light(const Drawing& all, const Occluders& occluders, int side) {
    for (int top = first_; top < first_ + rows_; top += side)
      for (int left = 0; left < width_; left += side) {
        int last = -1;
        double open = 1;
        for (int row = top; row < top + side; ++row)
          for (int column = left; column < left + side; ++column) {
            const std::size_t i = index(column, row);
            if (ball_[i] < 0) continue;
            const auto number = static_cast<std::size_t>(ball_[i]);
            const Ball& ball = all.balls[number];
            double dz;
            Vec3 normal;
            meet(ball, column + 0.5 - ball.centre[0], row + 0.5 - ball.centre[1], dz, normal);
            if (ball_[i] != last)
              open = number < occluders.size()
                         ? open_light(occluders[number], ball.centre + ball.radius * normal, normal)
                         : 1;
            last = ball_[i];
            colour_[i] = shade(ball.colour, normal, open, fog_at(all, depth_[i]));
          }
      }
  }

  static double fog_at(const Drawing& all, double z) {
    const double deep = all.nearest - all.farthest;
    return deep > 0 ? kFog * std::clamp((all.nearest - z) / deep, 0.0, 1.0) : 0;
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
        ball_[i] = -1;
      }
    }
  }

 private:
  /// Calls use(index, dx, dy) for the rays that pass nearer to the ball's centre than `radius`.
  template <class Use>
  void each_ray(const Ball& ball, double radius, Use&& use) {
    const double x = ball.centre[0], y = ball.centre[1];
    const auto [top, bottom] = span(y - radius, y + radius, first_, first_ + rows_);
    for (int row = top; row < bottom; ++row) {
      const double dy = row + 0.5 - y;
      const double half = std::sqrt(std::max(0.0, radius * radius - dy * dy));
      const auto [left, right] = span(x - half, x + half, 0, width_);
      for (int column = left; column < right; ++column)
        use(index(column, row), column + 0.5 - x, dy);
    }
  }
  void draw_shadow(const Shadow& shadow) {
    const auto [x, y] = shadow.centre;
    const auto [wide, high] = shadow.half_axes;
    const auto [top, bottom] = span(y - high, y + high, first_, first_ + rows_);
    const auto [left, right] = span(x - wide, x + wide, 0, width_);
    for (int row = top; row < bottom; ++row)
      for (int column = left; column < right; ++column) {
        const double dx = (column + 0.5 - x) / wide, dy = (row + 0.5 - y) / high;
        const double inside = 1 - dx * dx - dy * dy;
        if (!(inside > 0)) continue;
        for (float& c : colour_[index(column, row)]) c *= static_cast<float>(1 - inside * inside);
      }
  }
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
  std::vector<int> ball_;  // that the ray meets first; -1: none
};

}  // namespace

Image render(const Scene& scene, const Frame& frame, const Camera& camera,
             const RenderOptions& options) {
  const Drawing all = draw(scene, frame, camera, options);
  const Occluders occluders = find_occluders(all);
  const int n = options.supersampling;
  Image image{options.width, options.height, {}};
  image.pixels.reserve(static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
  for (int first = 0; first < image.height; first += kBandRows) {
    const int rows = std::min(kBandRows, image.height - first);
    Band band(n * image.width, n * first, n * rows);
    band.draw_floor(all);
    for (const Line& line : all.lines) band.draw(line);
    for (std::size_t i = 0; i < all.balls.size(); ++i) {
      const Ball& ball = all.balls[i];
      band.draw_outline(ball, n * options.letter_scale, Band::fog_at(all, ball.centre[2]));
      band.draw(ball, static_cast<int>(i));
    }
    band.light(all, occluders, n);
    for (const Ball& ball : all.touched) band.draw_translucent(ball, kTouchedOpacity, 0);
    for (const Ball& ball : all.translucent)
      band.draw_translucent(ball, kHipOpacity, kHiddenOpacity);
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
  if (options.letters) draw_labels(image, all.labels, options.letter_scale);
  return image;
}

std::vector<std::byte> encode_png(const Image& image) {
  // The simplified interface of libpng: the other one leaves functions by longjmp().
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<std::byte> bytes(size);
  if (!png_image_write_to_memory(&png, bytes.data(), &size, /*convert_to_8_bit=*/0,
                                 image.pixels.data(), /*row_stride=*/0, nullptr))
    throw Error(std::string("png: ") + png.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace hapgrid
