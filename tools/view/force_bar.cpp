#include "tools/view/force_bar.hpp"

#include <algorithm>
#include <cmath>

#include "libcore/base/text.hpp"
#include "libcore/scene/legend.hpp"
#include "libcore/scene/letters.hpp"

namespace hapgrid {

namespace {

constexpr Colour kTrack{0.87F, 0.88F, 0.9F};
constexpr Colour kForceFill{0.85F, 0.1F, 0.1F};
// In pixels at scale 1.
constexpr double kHalfWidth = 7;
constexpr double kFromEdge = 26;
constexpr double kSmallest = 150;  // of a picture's sides, for a bar

}  // namespace

void add_force_bar(Drawing& drawing, double newtons, double full, const RenderOptions& options) {
  if (std::min(options.width, options.height) < kSmallest) return;
  const double rays = options.supersampling;
  const double scale = options.letter_scale;
  const double x = options.width - scale * kFromEdge;
  const double bottom = options.height - scale * kFromEdge;
  const double top = 0.4 * options.height;
  const auto band = [&](double to, const Colour& colour) {
    drawing.overlay.push_back({{rays * x, rays * bottom, 0},
                               {rays * x, rays * to, 0},
                               rays * scale * kHalfWidth,
                               colour});
  };
  band(top, kTrack);
  const double part = std::clamp(newtons / full, 0.0, 1.0);
  if (part > 0) band(bottom + part * (top - bottom), kForceFill);
  if (!options.letters) return;
  const Label label{rounded(full) + " N", {x, top - scale * (kHalfWidth + kLetterHeight)}};
  const double width = scale * kLetterWidth * static_cast<double>(label.text.size());
  add_label(drawing, {label.text, {x - width / 2, label.left[1]}}, options);
}

}  // namespace hapgrid
