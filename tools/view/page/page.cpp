#include "tools/view/page/page.hpp"

#include <glib.h>

#include <nlohmann/json.hpp>

#include "libcore/base/json_text.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/box.hpp"
#include "libcore/scene/torsion.hpp"
#include "tools/view/page/parts.hpp"

namespace hapgrid {

namespace {

/// Numbers as a browser's typed arrays hold them, in base 64.
template <class T>
std::string encoded(const std::vector<T>& values) {
  gchar* const text =
      g_base64_encode(reinterpret_cast<const guchar*>(values.data()), values.size() * sizeof(T));
  std::string result(text);
  g_free(text);
  return result;
}

void append(std::vector<float>& values, const Vec3& v) {
  for (const double x : v) values.push_back(static_cast<float>(x));
}

/// JSON that can stand in a script: a stream's strings cannot end it.
std::string script_of(const nlohmann::ordered_json& json) {
  std::string text;
  for (const char c : json_line(json))
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  return text;
}

}  // namespace

void Page::add(const Frame& frame) {
  if (!times_.empty() && frame.jumps != jumps_) snaps_.push_back(times_.size());
  jumps_ = frame.jumps;
  times_.push_back(frame.time_s);
  append(hips_, frame.position);
  append(forces_, frame.force);
  energies_.push_back(static_cast<float>(frame.energy));
  own_energies_.push_back(static_cast<float>(frame.own_energy));
  for (const double degrees : frame.turned) turned_.push_back(static_cast<float>(degrees));
  centres_.insert(centres_.end(), frame.centres.begin(), frame.centres.end());
}

std::string Page::finish(const Scene& scene, const RenderOptions& options, double azimuth_degrees,
                         double elevation_degrees) const {
  const Box& box = scene.box;
  nlohmann::ordered_json data = {
      {"model", printable_line(scene.model)},
      {"length_unit", unit_sign(scene.length_unit)},
      {"energy_unit", printable_line(scene.energy_unit)},
      {"energy_label",
       axis_label("energy", scene.energy_unit.empty() ? "model's unit" : scene.energy_unit)},
      {"sticks", options.sticks},
      {"low", box.origin},
      {"high",
       box.position(GridCoordinates{box.counts[0] - 1, box.counts[1] - 1, box.counts[2] - 1})},
      {"hip_radius", hip_radius(scene, options)},
      {"newton", newton_length(scene, options)},
      {"azimuth", azimuth_degrees},
      {"elevation", elevation_degrees},
      {"snaps", snaps_},
      {"spheres", nlohmann::ordered_json::array()}};
  for (const Sphere& sphere : scene.spheres)
    data["spheres"].push_back(
        {sphere.radius, sphere.colour[0], sphere.colour[1], sphere.colour[2]});
  data["torsions"] = nlohmann::ordered_json::array();
  for (const Torsion& torsion : scene.torsions)
    data["torsions"].push_back(
        {printable_line(torsion.name), torsion.spheres[1], torsion.spheres[2]});
  data["least_turn"] = kTurned;
  data["turned"] = encoded(turned_);
  data["own_energies"] = encoded(own_energies_);
  data["times"] = encoded(times_);
  data["hips"] = encoded(hips_);
  data["forces"] = encoded(forces_);
  data["energies"] = encoded(energies_);
  data["centres"] = encoded(centres_);
  return std::string(kPageHead) + kPageThree +
         "\n</script>\n<script>\nconst data = " + script_of(data) + ";\n" + kPageScript +
         "</script>\n</body>\n</html>\n";
}

}  // namespace hapgrid
