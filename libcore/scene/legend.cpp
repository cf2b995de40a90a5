#include "libcore/scene/legend.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "libcore/base/text.hpp"
#include "libcore/scene/letters.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

namespace {

/// The largest of 1, 2 and 5 times a power of ten that is not above `most`.
double round_length(double most) {
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double digit : {5.0, 2.0})
    if (digit * power <= most) return digit * power;
  return power;
}

/// From and to a place in pixels.
void add_line(Drawing& drawing, const Vec3& from, const Vec3& to, const RenderOptions& options) {
  const double rays = options.supersampling;
  drawing.overlay.push_back(
      {rays * from, rays * to, 0.5 * kLegendLine * rays * options.letter_scale, kInk});
}

}  // namespace

std::string length_text(const Scene& scene, double length) {
  return rounded(length) + " " + counted_unit(scene.length_unit, length);
}

double names_width(const Scene& scene) {
  double wide = 0;
  for (const Torsion& torsion : scene.torsions)
    wide = std::max(wide, letters_width(torsion_text(torsion, 180)) + 3 * kMargin);
  return wide;
}

void add_legend(Drawing& drawing, const Scene& scene, const Camera& camera,
                const RenderOptions& options) {
  const double scale = options.letter_scale, shorter = std::min(options.width, options.height);
  const double pixels = shorter / (2 * camera.half_width);
  const double length = round_length(kBarPart * options.width / pixels);
  const double bar = length * pixels;
  if (!std::isfinite(bar)) return;  // an absurd camera
  const double left = scale * kMargin, bottom = options.height - scale * kMargin - 0.5;
  add_line(drawing, {left, bottom, 0}, {left + bar, bottom, 0}, options);
  for (const double x : {left, left + bar})
    add_line(drawing, {x, bottom - kBarEnd * scale, 0}, {x, bottom + kBarEnd * scale, 0}, options);
  drawing.labels.push_back({length_text(scene, length), {left + bar + kBarGap * scale, bottom}});

  const double axis = std::min(scale * kAxis, kAxisPart * shorter);
  const Vec3 right = camera.right(), up = camera.up();
  const Vec3 middle{scale * kAxesAside + axis, options.height - scale * kAxesAbove - 0.5 - axis, 0};
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 way{right[a], -up[a], 0};
    if (length_of(way) < kShortestAxis) continue;  // it points at the viewer
    add_line(drawing, middle, middle + axis * way, options);
    const Vec3 name = middle + (axis + scale * kAxisGap) * way;
    drawing.labels.push_back(
        {std::string(1, "xyz"[a]), {name[0] - 0.5 * scale * kLetterWidth, name[1]}});
  }
}

void add_names(Drawing& drawing, std::vector<std::pair<Vec3, std::string>> names,
               const RenderOptions& options) {
  const double scale = options.letter_scale, rays = options.supersampling;
  double beside = 0;
  for (std::size_t i = 0; i < drawing.spheres; ++i)
    beside = std::max(beside, (drawing.balls[i].centre[0] + drawing.balls[i].radius) / rays);
  std::sort(names.begin(), names.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first[1], a.second) < std::tie(b.first[1], b.second);
  });
  double y = scale * kMargin;
  auto left_over = static_cast<double>(names.size());
  for (const auto& [at, text] : names) {
    const double most = options.width - scale * (letters_width(text) + kMargin);
    const double left = std::min(beside + 2 * scale * kMargin, most);
    const double rest = scale * kNameRow * left_over--;
    y = std::max(y, std::min(at[1] / rays, options.height - rest));
    const Vec3 from{left - 0.5 * scale * kMargin, y, 0};
    const Vec3 way = (1 / rays) * at - from;
    add_line(drawing, from, from + std::max(0.0, (beside - from[0]) / way[0]) * way, options);
    for (const auto& [radius, colour] : {std::pair(kDot + 1, kBackground), {kDot, kInk}})
      drawing.overlay.push_back({at, at, radius * scale * rays, colour});
    drawing.labels.push_back({text, {left, y}});
    y += scale * kNameRow;
  }
}

}  // namespace hapgrid
