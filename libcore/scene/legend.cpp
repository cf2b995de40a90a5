#include "libcore/scene/legend.hpp"

#include <algorithm>
#include <cmath>

#include "libcore/base/text.hpp"
#include "libcore/scene/letters.hpp"

namespace hapgrid {

namespace {

// In pixels at scale 1.
constexpr double kMargin = 10;
constexpr double kBeside = 16;     // from the picture's edge, for the text at an axis to the left
constexpr double kSmallest = 150;  // of a picture's sides, for a legend

/// The largest of 1, 2 and 5 times a power of ten that is not above `most`.
double round_length(double most) {
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double digit : {5.0, 2.0})
    if (digit * power <= most) return digit * power;
  return power;
}

/// The axes and their names, from one place; those that point at the viewer are left out.
void add_axes(Legend& legend, const Camera& camera, const RenderOptions& options) {
  const double scale = options.letter_scale;
  const double length =
      std::min(scale * kAxis, kAxisPart * std::min(options.width, options.height));
  const PictureAxes axes(camera);
  const double left = scale * kMargin, bottom = options.height - scale * kMargin - 0.5;
  const std::array<double, 2> middle{left + length + scale * kBeside, bottom - length - scale * 30};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::array<double, 2> way{axes.right[a], -axes.up[a]};
    const double shown = std::hypot(way[0], way[1]);
    if (shown < kShortestAxis) continue;
    const auto at = [&](double distance) {
      return std::array{middle[0] + distance * way[0] / shown,
                        middle[1] + distance * way[1] / shown};
    };
    legend.lines.push_back({{middle, at(length * shown)}});
    const auto name = at(length * shown + scale * kAxisGap);
    legend.labels.push_back(
        {std::string(1, "xyz"[a]), {name[0] - 0.5 * scale * kLetterWidth, name[1]}});
  }
}

}  // namespace

std::string length_text(const Scene& scene, double length) {
  return rounded(length) + " " + unit_sign(scene.length_unit);
}

Legend make_legend(const Scene& scene, const Camera& camera, const RenderOptions& options) {
  Legend legend;
  const double scale = options.letter_scale;
  if (std::min(options.width, options.height) < kSmallest) return legend;
  const double pixels = std::min(options.width, options.height) / (2 * camera.half_width);
  const double length = round_length(0.25 * options.width / pixels);
  const double bar = length * pixels;
  if (!std::isfinite(bar)) return legend;  // an absurd camera
  const double left = scale * kMargin, bottom = options.height - scale * kMargin - 0.5;
  legend.lines.push_back({{{left, bottom}, {left + bar, bottom}}});
  for (const double x : {left, left + bar})
    legend.lines.push_back({{{x, bottom - 3 * scale}, {x, bottom + 3 * scale}}});
  legend.labels.push_back({length_text(scene, length), {left + bar + 5 * scale, bottom}});

  add_axes(legend, camera, options);
  return legend;
}

void add_plate(Drawing& drawing, const std::string& text, double x, double y,
               const RenderOptions& options) {
  const double rays = options.supersampling;
  const double half = 0.5 * options.letter_scale * letters_width(text);
  drawing.overlay.push_back({{x - rays * half, y, 0},
                             {x + rays * half, y, 0},
                             0.6 * rays * options.letter_scale * kLetterHeight,
                             kBackground});
  drawing.labels.push_back({text, {x / rays - half, y / rays}});
}

void add_legend(Drawing& drawing, const Scene& scene, const Camera& camera,
                const RenderOptions& options) {
  const Legend legend = make_legend(scene, camera, options);
  const double rays = options.supersampling;
  for (const auto& [from, to] : legend.lines)
    drawing.overlay.push_back({{rays * from[0], rays * from[1], 0},
                               {rays * to[0], rays * to[1], 0},
                               0.6 * rays * options.letter_scale,
                               kInk});
  if (options.letters)
    drawing.labels.insert(drawing.labels.end(), legend.labels.begin(), legend.labels.end());
}

}  // namespace hapgrid
