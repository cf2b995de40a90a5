#include "libcore/scene/legend.hpp"

#include <algorithm>
#include <cmath>

#include "libcore/base/text.hpp"
#include "libcore/scene/letters.hpp"

namespace hapgrid {

namespace {

constexpr Colour kInk{0.16F, 0.17F, 0.2F};
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

/// Each row of a letter's fine pixels, which are `fine` wide, as lines.
void add_letter(std::vector<Line>& lines, char letter, double x, double y, double fine) {
  constexpr int kColumns = kFine * kLetterWidth;
  const LetterRows rows = letter_rows(letter);
  for (int row = 0; row < kFine * kLetterHeight; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const auto set = [&](int i) {
        return i < kColumns && (rows[static_cast<std::size_t>(row)] >> (kColumns - 1 - i) & 1) != 0;
      };
      if (!set(column)) continue;
      int last = column;
      while (set(last + 1)) ++last;
      const double middle = y + fine * (row + 0.5);
      lines.push_back({{x + fine * (column + 0.5), middle, 0},
                       {x + fine * (last + 0.5), middle, 0},
                       0.55 * fine,
                       kInk});
      column = last;
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

void add_label(Drawing& drawing, const Label& label, const RenderOptions& options) {
  const double rays = options.supersampling;
  const double pixel = rays * options.letter_scale;
  const std::string letters = letters_of(label.text);
  for (std::size_t i = 0; i < letters.size(); ++i)
    add_letter(drawing.overlay, letters[i],
               rays * label.left[0] + pixel * kLetterWidth * static_cast<double>(i),
               rays * label.left[1] - pixel * kLetterHeight / 2, pixel / kFine);
}

void add_plate(Drawing& drawing, const std::string& text, double x, double y,
               const RenderOptions& options) {
  const double rays = options.supersampling;
  const double half =
      0.5 * options.letter_scale * kLetterWidth * static_cast<double>(letters_of(text).size());
  drawing.overlay.push_back({{x - rays * half, y, 0},
                             {x + rays * half, y, 0},
                             0.6 * rays * options.letter_scale * kLetterHeight,
                             kBackground});
  add_label(drawing, {text, {x / rays - half, y / rays}}, options);
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
  if (!options.letters) return;
  for (const Label& label : legend.labels) add_label(drawing, label, options);
}

}  // namespace hapgrid
