#include "tools/view/report.hpp"

#include <nlohmann/json.hpp>

#include "libcore/base/format.hpp"
#include "libcore/base/json_text.hpp"
#include "libcore/base/table.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

using Json = nlohmann::ordered_json;

namespace {

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : format("{} {}", text, printable_line(unit));
}

}  // namespace

std::string report_text(const Scene& scene, const SceneSummary& s) {
  std::string text;
  const auto row = [&](const std::string& name, const std::string& value) {
    text += format("{}{}\n", left(name, 9), value);
  };
  row("model", printable_line(scene.model));
  row("frames", s.frames == 0 ? "0"
                              : format("{}, from {} s to {} s", s.frames, rounded(s.first_s),
                                       rounded(s.last_s)));
  const auto range = [](const SceneSummary::Range& r) {
    return format("{} .. {}", rounded(r.first), rounded(r.second));
  };
  const std::string count = format("{}", scene.spheres.size());
  row("spheres", !s.bounds
                     ? count
                     : with_unit(format("{}, in x {}, y {}, z {}", count, range((*s.bounds)[0]),
                                        range((*s.bounds)[1]), range((*s.bounds)[2])),
                                 scene.length_unit));
  row("force", s.largest_force > 0 ? format("at most {} N, at {} s", rounded(s.largest_force),
                                            rounded(s.largest_force_s))
                                   : "none");
  if (s.energy) row("energy", with_unit(range(*s.energy), scene.energy_unit));
  return text;
}

std::string report_json(const Scene& scene, const SceneSummary& s) {
  const Box& box = scene.box;
  Json json = {{"version", 1},
               {"model", scene.model},
               {"length_unit", scene.length_unit},
               {"energy_unit", scene.energy_unit},
               {"box", {{"origin", box.origin}, {"spacing", box.spacing}, {"counts", box.counts}}},
               {"state_size", scene.state_size},
               {"spheres", scene.spheres.size()},
               {"frames", s.frames}};
  json["first_s"] = s.frames > 0 ? Json(s.first_s) : Json();
  json["last_s"] = s.frames > 0 ? Json(s.last_s) : Json();
  json["bounds"] = Json();
  if (s.bounds)
    for (const auto& [low, high] : *s.bounds) json["bounds"].push_back({low, high});
  json["largest_force"] = s.largest_force;
  json["largest_force_s"] = s.largest_force > 0 ? Json(s.largest_force_s) : Json();
  json["energy"] = s.energy ? Json({s.energy->first, s.energy->second}) : Json();
  return json_text(json);
}

}  // namespace hapgrid
