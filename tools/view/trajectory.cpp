#include "tools/view/trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

// <cctype> depends on the locale.
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string triple(const Vec3& v) {
  return format("{},{},{}", to_text(v[0]), to_text(v[1]), to_text(v[2]));
}

/// The comment of a frame, without an end of line.
std::string comment(const Frame& frame) {
  const std::string text = format("time={} tick={} hip={} force={}", to_text(frame.time_s),
                                  frame.tick, triple(frame.hip), triple(frame.force));
  return std::isnan(frame.energy) ? text : format("{} energy={}", text, to_text(frame.energy));
}

/// The units of a comment as one more word of it; in quotes, since it has blanks.
std::string units(const Scene& scene, const Frame& frame) {
  std::string names = format("time s, hip {}, force N", unit_sign(scene.length_unit));
  if (!std::isnan(frame.energy)) names += format(", energy {}", unit_sign(scene.energy_unit));
  std::replace(names.begin(), names.end(), '"', '\'');
  return format(" units=\"{}\"", printable_line(names));
}

/// Fixed notation: some readers of XYZ know no exponents. Six decimals are below a float's
/// resolution from 16 units on, and finer than any picture of atoms before.
void append_xyz_coordinate(std::string& text, double value) {
  if (!std::isfinite(value)) throw Error("a coordinate is not finite");
  text += ' ';
  text += fixed(value, 6);
}

}  // namespace

bool is_symbol(const std::string& label) {
  return !label.empty() && is_letter(label[0]) &&
         std::all_of(label.begin(), label.end(),
                     [](char c) { return is_letter(c) || is_digit(c); });
}

void append_xyz(std::string& text, const Scene& scene, const Frame& frame,
                const std::string& hip_label) {
  const bool with_hip = !hip_label.empty();
  text += format("{}\n{}\n", scene.spheres.size() + (with_hip ? 1 : 0),
                 comment(frame) + units(scene, frame));
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const std::string& label = scene.spheres[i].label;
    text += is_symbol(label) ? label : "X";
    for (int a = 0; a < 3; ++a) append_xyz_coordinate(text, frame.centres[3 * i + a]);
    text += '\n';
  }
  if (!with_hip) return;
  text += hip_label;
  for (const double x : frame.position) append_xyz_coordinate(text, x);
  text += '\n';
}

}  // namespace hapgrid
