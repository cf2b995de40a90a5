#include "tools/view/page/page.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/box.hpp"
#include "libcore/scene/drawing.hpp"
#include "libcore/scene/legend.hpp"
#include "libcore/scene/light.hpp"
#include "libcore/scene/scene.hpp"
#include "tools/page/coupled_hip.hpp"
#include "tools/view/status.hpp"

namespace hapgrid {

// page.html and the scripts; embed.cmake makes them.
extern const char *const kPageHead, *const kPageScript;

using Json = nlohmann::ordered_json;

namespace {

/// As CSS has it.
std::string css(const Colour& c) {
  return format("rgb({} {} {})", 255 * c[0], 255 * c[1], 255 * c[2]);
}

/// By the names that the shaders have for them.
Json light_numbers() {
  using namespace light;
  return {{"ambient", kAmbient},
          {"diffuse", kDiffuse},
          {"shine", kShine},
          {"light_from", kFrom},
          {"half_way", kHalfWay},
          {"fog", kFog},
          {"reach", kReach},
          {"open", kOpen},
          {"fading", kFading},
          {"least_open", kLeastOpen},
          {"most_open", kMostOpen},
          {"outline_depth", kOutlineDepth},
          {"outline_light", kOutlineLight},
          {"floor_light", kFloor},
          {"shadow", kShadow},
          {"box_rgb", kBoxColour}};
}

/// Of each sphere that is an atom its element and its number, as tables and torsions name it.
Json names_of(const Scene& scene) {
  Json names = Json::array();
  for (const Sphere& sphere : scene.spheres)
    names.push_back(sphere.label.empty()
                        ? std::string()
                        : format("{}{}", printable_line(sphere.label), names.size() + 1));
  return names;
}

/// What stands at an axis of energies: "energy / (kJ/mol)".
std::string energy_label(const std::string& unit) {
  const std::string sign = unit.empty() ? "model's unit" : unit_sign(unit);
  return "energy / " + (sign.find('/') == sign.npos ? sign : "(" + sign + ")");
}

}  // namespace

Json page_scene(const Scene& scene, const Frame& frame, const RenderOptions& options) {
  const Box& box = scene.box;
  Camera camera;
  const auto extent = fit_extent(scene, frame, options, camera);
  const auto [hand_low, hand_high] = hand_range(box);
  Json data = {{"model", printable_line(scene.model)},
               {"energy_label", energy_label(scene.energy_unit)},
               {"keys", printable_line(scene.keys)},
               {"sticks", options.sticks},
               {"ball_part", kBallPart},
               {"stick_part", kStickPart},
               {"low", box.origin},
               {"high", box.high()},
               {"hand_low", hand_low},
               {"hand_high", hand_high},
               {"hip_radius", hip_radius(scene)},
               {"full_force", scene.largest_force},
               {"hip_rgb", kHipColour},
               {"hip_opacity", kHipOpacity},
               {"hidden_opacity", kHiddenOpacity},
               {"touched_opacity", kTouchedOpacity},
               {"touch", kTouch},
               {"force_rgb", kForceColour},
               {"hand_colour", css(kHipColour)},
               {"force_colour", css(kForceColour)},
               {"snap_colour", css(kSnapColour)},
               {"energy_colour", css(kEnergyColour)},
               {"line_pixels", 2 * kLinePixels},
               {"ring_pixels", kRingPixels},
               {"hand_line_pixels", 2 * kHandPixels},
               {"flash_pixels", kFlashPixels},
               {"shadow_radii", kShadowRadii},
               {"most_occluders", light::kMostOccluders},
               {"most_shaded", light::kMostShaded},
               {"light", light_numbers()},
               {"ink", css(kInk)},
               {"legend",
                {{"margin", kMargin},
                 {"axis", kAxis},
                 {"axis_part", kAxisPart},
                 {"axes_aside", kAxesAside},
                 {"axes_above", kAxesAbove},
                 {"axis_gap", kAxisGap},
                 {"shortest_axis", kShortestAxis},
                 {"line", kLegendLine},
                 {"dot", kDot},
                 {"bar_end", kBarEnd},
                 {"bar_gap", kBarGap},
                 {"bar_part", kBarPart},
                 {"name_row", kNameRow},
                 {"smallest", kSmallest},
                 {"names_width", names_width(scene)},
                 {"names_part", kNamesPart}}},
               {"axes", {camera.right(), camera.up(), camera.near()}},
               {"centre", camera.centre},
               {"extent", extent},
               {"lengths", Json::array()},
               {"spheres", Json::array()}};
  const double decade = std::floor(std::log10(std::max(extent[0], extent[1])));
  if (!std::isfinite(decade))
    throw Error("the picture has no size: a radius or the box is too large");
  for (double power = decade - 4; power <= decade + 2; ++power)
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double length = digit * std::pow(10, power);
      data["lengths"].push_back({length, length_text(scene, length)});
    }
  for (const Sphere& sphere : scene.spheres)
    data["spheres"].push_back(
        {sphere.radius, sphere.colour[0], sphere.colour[1], sphere.colour[2]});
  data["names"] = names_of(scene);
  return data;
}

Json page_frame(const Scene& scene, const Frame& frame) {
  // To a thousandth of the grid's spacing, or finer.
  const double parts = std::pow(10, 3 - std::floor(std::log10(scene.box.spacing)));
  Json centres = Json::array(), turned = Json::array();
  for (const double x : frame.centres) centres.push_back(std::round(x * parts) / parts);
  for (std::size_t i = 0; i < frame.turned.size(); ++i)
    if (std::abs(frame.turned[i]) >= kTurned) {
      const Torsion& torsion = scene.torsions[i];
      turned.push_back(
          {torsion.spheres[1], torsion.spheres[2], torsion_text(torsion, frame.angles[i])});
    }
  return {{"time", frame.time_s},
          {"jumps", frame.jumps},
          {"hip", frame.position},
          {"force", frame.force},
          {"hand", frame.hand},
          {"energy", frame.energy},
          {"own", frame.own_energy},
          {"arrow", arrow_sizes(scene, frame)},
          {"centres", centres},
          {"bonds", find_bonds(scene, frame)},
          {"status", status_text(scene, frame)},
          {"turned", turned}};
}

std::string page_text(const std::string& data, const std::string& shown,
                      const std::string& packed) {
  return format(
      "{}\"use strict\";\nlet data = {};\nconst recorded = [{}];\nconst packed = {};\n{}</script>\n"
      "</body>\n</html>\n",
      kPageHead, data, shown, packed, kPageScript);
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

}  // namespace hapgrid
