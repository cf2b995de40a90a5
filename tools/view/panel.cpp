#include "tools/view/panel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libcore/base/table.hpp"
#include "libcore/base/text.hpp"
#include "tools/view/canvas.hpp"

namespace hapgrid {

namespace {

constexpr Rgb kPaper{246, 247, 249};
constexpr Rgb kFrame{205, 209, 216};
constexpr Rgb kInk{40, 44, 52};
constexpr Rgb kForce{217, 26, 26};
constexpr Rgb kEnergy{30, 90, 190};
constexpr Rgb kOwnEnergy{0, 140, 100};
constexpr Rgb kSwitch{240, 150, 30};
constexpr Rgb kPale{150, 155, 165};

// Pixels at scale 1.
constexpr int kStatusHeight = kLetterHeight + 7;
constexpr int kMargin = 4;
constexpr int kLabelWidth = 17 * kLetterWidth;
constexpr std::size_t kLongestName = 10;  // of a curve, in letters, on one line

struct Place {
  int x, y, width, height;
};

/// Where the curves show this time.
int column_of(const Place& place, int scale, const Traces& traces, double time_s) {
  const double end_s = traces.samples().empty() ? 0 : traces.samples().back().time_s;
  return place.x +
         static_cast<int>((1 - (end_s - time_s) / Traces::kSeconds) * (place.width - scale));
}

/// A curve alone.
void draw_line(Image& image, const Place& place, int scale, const Traces& traces,
               double Traces::Sample::*value, const Extent& extent, Rgb colour) {
  bool drawn = false;  // a point that the next one is joined with
  int last_x = 0, last_y = 0;
  for (const auto& sample : traces.samples()) {
    const double at = extent(sample.*value);
    if (!std::isfinite(at)) {
      drawn = false;
      continue;
    }
    const int px = column_of(place, scale, traces, sample.time_s);
    const int py = place.y + static_cast<int>(std::lround((1 - at) * (place.height - scale)));
    line(image, drawn ? last_x : px, drawn ? last_y : py, px, py, scale, colour);
    drawn = true;
    last_x = px;
    last_y = py;
  }
}

/// A curve in its frame, with its name and the ends of its axis on the left.
void draw_curve(Image& image, const Place& place, int scale, const Traces& traces,
                double Traces::Sample::*value, const Extent& extent, const std::string& name,
                Rgb colour) {
  const int x = place.x, y = place.y, width = place.width, height = place.height;
  const int middle = y + (height - scale * kLetterHeight) / 2;
  // On two lines where it is long: the quantity, and its unit.
  const std::size_t slash = name.size() > kLongestName ? name.find(" / ") : name.npos;
  const int half = slash == name.npos ? 0 : scale * kLetterHeight / 2;
  write(image, scale * kMargin, middle - half, scale, name.substr(0, slash), colour);
  if (half > 0) write(image, scale * kMargin, middle + half, scale, name.substr(slash + 1), colour);
  const auto label = [&](int top, double number) {
    const std::string text = three_digits(number);
    write(image, x - scale * (kLetterWidth * static_cast<int>(text.size()) + kMargin), top, scale,
          text, kInk);
  };
  label(y - scale, extent.high);
  label(y + height - scale * (kLetterHeight - 1), extent.low);

  fill(image, x, y, width, height, {255, 255, 255});
  const double end_s = traces.samples().empty() ? 0 : traces.samples().back().time_s;
  const auto column = [&](double time_s) { return column_of(place, scale, traces, time_s); };
  for (int s = 1; s < Traces::kSeconds; ++s)
    fill(image, column(end_s - s), y, scale, height, {232, 234, 238});
  write(image, x + scale * kMargin, y + height - scale * kLetterHeight, scale,
        "t / s: the last 10 s", kPale);
  static_assert(Traces::kSeconds == 10);
  for (const auto& sample : traces.samples())
    if (sample.snapped) fill(image, column(sample.time_s), y, scale, height, kSwitch);
  for (const int edge : {y - scale, y + height})
    fill(image, x - scale, edge, width + 2 * scale, scale, kFrame);
  for (const int edge : {x - scale, x + width}) fill(image, edge, y, scale, height, kFrame);

  draw_line(image, place, scale, traces, value, extent, colour);
}

Image paper(int width, int scale) {
  Image image = blank(width, scale * kPanelHeight, kPaper);
  fill(image, 0, 0, width, scale, kFrame);
  return image;
}

}  // namespace

Image draw_text(int width, int scale, const std::vector<std::string>& lines) {
  Image image = paper(width, scale);
  int y = scale * kMargin;
  for (const std::string& line : lines) {
    write(image, scale * kMargin, y, scale, line, kInk);
    y += scale * (kLetterHeight + 1);
  }
  return image;
}

Image draw_panel(int width, int scale, const Scene& scene, const Traces& traces,
                 const std::string& status) {
  const int height = scale * kPanelHeight;
  Image image = paper(width, scale);
  write(image, scale * kMargin, scale * kMargin, scale, status, kInk);

  const Extent energy = energy_extent(traces);
  const bool both = std::isfinite(energy.low);
  const int gap = scale * 2 * kMargin;
  Place place{scale * kLabelWidth, scale * (kStatusHeight + 1), 0, 0};
  place.width = width - place.x - scale * (kMargin + 1);
  place.height = height - place.y - scale * (kMargin + 1);
  if (place.width < scale * 20) return image;  // no room for curves
  if (both) place.height = (place.height - gap) / 2;
  draw_curve(image, place, scale, traces, &Traces::Sample::force, force_extent(traces), "force / N",
             kForce);
  if (!both) return image;
  place.y += place.height + gap;
  draw_curve(image, place, scale, traces, &Traces::Sample::energy, energy,
             axis_label("energy", scene.energy_unit.empty() ? "model's unit" : scene.energy_unit),
             kEnergy);
  const bool own = std::any_of(traces.samples().begin(), traces.samples().end(),
                               [](const auto& s) { return std::isfinite(s.own_energy); });
  if (!own) return image;
  draw_line(image, place, scale, traces, &Traces::Sample::own_energy, energy, kOwnEnergy);
  const std::string what = "of the model alone";
  write(image, place.x + place.width - scale * kLetterWidth * static_cast<int>(what.size() + 1),
        place.y, scale, what, kOwnEnergy);
  return image;
}

}  // namespace hapgrid
