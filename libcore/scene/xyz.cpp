#include "libcore/scene/xyz.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

/// Fixed notation: some readers of XYZ know no exponents. Six decimals are below a float's
/// resolution from 16 units on, and finer than any picture of atoms before.
void append_coordinate(std::string& text, double value) {
  if (!std::isfinite(value)) throw Error("a coordinate is not finite");
  char buffer[400];  // the longest double has 309 digits in front of the point
  text += ' ';
  text.append(buffer,
              std::to_chars(buffer, std::end(buffer), value, std::chars_format::fixed, 6).ptr);
}

std::string triple(const Vec3& v) {
  return to_text(v[0]) + "," + to_text(v[1]) + "," + to_text(v[2]);
}

// <cctype> depends on the locale.
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

bool is_symbol(const std::string& label) {
  return !label.empty() && is_letter(label[0]) &&
         std::all_of(label.begin(), label.end(),
                     [](char c) { return is_letter(c) || is_digit(c); });
}

std::string frame_comment(const Frame& frame) {
  std::string text = "time=" + to_text(frame.time_s) + " tick=" + std::to_string(frame.tick) +
                     " hip=" + triple(frame.hip) + " force=" + triple(frame.force);
  if (!std::isnan(frame.energy)) text += " energy=" + to_text(frame.energy);
  return text;
}

void append_xyz(std::string& text, const Scene& scene, const Frame& frame,
                const std::string& hip_label) {
  const bool with_hip = !hip_label.empty();
  text += std::to_string(scene.spheres.size() + (with_hip ? 1 : 0)) + "\n";
  text += frame_comment(frame) + "\n";
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const std::string& label = scene.spheres[i].label;
    text += is_symbol(label) ? label : "X";
    for (int a = 0; a < 3; ++a) append_coordinate(text, frame.centres[3 * i + a]);
    text += '\n';
  }
  if (!with_hip) return;
  text += hip_label;
  for (const double x : frame.position) append_coordinate(text, x);
  text += '\n';
}

}  // namespace hapgrid
