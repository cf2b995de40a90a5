#include "tools/view/page/page.hpp"

#include <glib.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "libcore/base/format.hpp"
#include "libcore/base/json_text.hpp"
#include "libcore/base/text.hpp"
#include "libcore/device/hand.hpp"
#include "libcore/grid/box.hpp"
#include "libcore/scene/bonds.hpp"
#include "libcore/scene/legend.hpp"
#include "libcore/scene/torsion.hpp"
#include "tools/view/hand.hpp"
#include "tools/view/page/parts.hpp"

namespace hapgrid {

namespace {

static_assert(std::endian::native == std::endian::little);

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append(std::string& bytes, const Vec3& v) {
  for (const double x : v) append(bytes, static_cast<float>(x));
}

/// As CSS has it.
std::string css(const Colour& colour) {
  const auto part = [&](std::size_t i) { return static_cast<int>(std::lround(255 * colour[i])); };
  return format("#{:02x}{:02x}{:02x}", part(0), part(1), part(2));
}

}  // namespace

nlohmann::ordered_json page_scene(const Scene& scene, const Frame& frame,
                                  const RenderOptions& options, double azimuth_degrees,
                                  double elevation_degrees) {
  const Box& box = scene.box;
  Camera camera{azimuth_degrees, elevation_degrees};
  const auto extent = fit_extent(scene, frame, options, camera);
  const auto [hand_low, hand_high] = hand_range(box);
  nlohmann::ordered_json data = {
      {"model", printable_line(scene.model)},
      {"energy_unit", printable_line(scene.energy_unit)},
      {"energy_label",
       axis_label("energy", scene.energy_unit.empty() ? "model's unit" : scene.energy_unit)},
      {"keys", printable_line(scene.keys)},
      {"sticks", options.sticks},
      {"ball_part", kBallPart},
      {"stick_part", kStickPart},
      {"low", box.origin},
      {"high",
       box.position(GridCoordinates{box.counts[0] - 1, box.counts[1] - 1, box.counts[2] - 1})},
      {"hand_low", hand_low},
      {"hand_high", hand_high},
      {"hip_radius", hip_radius(scene, options)},
      {"newton", newton_length(scene, options)},
      {"full_force", scene.largest_force},
      {"hip_rgb", kHipColour},
      {"force_rgb", kForceColour},
      {"hand_colour", css(kHipColour)},
      {"force_colour", css(kForceColour)},
      {"snap_colour", css(kSnapColour)},
      {"energy_colour", "#1e5abe"},
      {"own_colour", "#7c3aed"},
      {"arrow_parts", kArrowParts},
      {"arrow_most", kArrowMost},
      {"azimuth", azimuth_degrees},
      {"elevation", elevation_degrees},
      {"centre", camera.centre},
      {"extent", extent},
      {"least_turn", kTurned},
      {"lengths", nlohmann::ordered_json::array()},
      {"spheres", nlohmann::ordered_json::array()},
      {"torsions", nlohmann::ordered_json::array()}};
  const double decade = std::floor(std::log10(std::max(extent[0], extent[1])));
  for (double power = decade - 4; power <= decade + 2; ++power)
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double length = digit * std::pow(10, power);
      data["lengths"].push_back({length, length_text(scene, length)});
    }
  for (const Sphere& sphere : scene.spheres)
    data["spheres"].push_back(
        {sphere.radius, sphere.colour[0], sphere.colour[1], sphere.colour[2]});
  for (const Torsion& torsion : scene.torsions)
    data["torsions"].push_back(
        {printable_line(torsion.name), torsion.spheres[1], torsion.spheres[2]});
  return data;
}

std::string page_frame(const Scene& scene, const Frame& frame) {
  std::string bytes;
  append(bytes, frame.time_s);
  append(bytes, static_cast<double>(frame.jumps));
  append(bytes, frame.position);
  append(bytes, frame.force);
  append(bytes, frame.hand);
  append(bytes, static_cast<float>(frame.energy));
  append(bytes, static_cast<float>(frame.own_energy));
  for (std::size_t i = 0; i < scene.torsions.size(); ++i)
    append(bytes, static_cast<float>(i < frame.turned.size() ? frame.turned[i] : NAN));
  for (const float x : frame.centres) append(bytes, x);
  for (const auto& bond : find_bonds(scene, frame))
    for (const std::uint32_t end : bond) append(bytes, static_cast<std::uint16_t>(end));
  return bytes;
}

std::string page_text(const std::string& data) {
  return std::string(kPageHead) + kPageThree + "\n</script>\n<script>\nlet data = " + data + ";\n" +
         kPageScript + "</script>\n</body>\n</html>\n";
}

std::string script_of(const nlohmann::ordered_json& json) {
  std::string text;
  for (const char c : json_line(json))
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  return text;
}

std::string base64(const std::string& bytes) {
  gchar* const text = g_base64_encode(reinterpret_cast<const guchar*>(bytes.data()), bytes.size());
  std::string result(text);
  g_free(text);
  return result;
}

}  // namespace hapgrid
