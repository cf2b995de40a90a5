#include "libcore/model/handshake.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "libcore/base/text.hpp"

namespace hapgrid {

using Json = nlohmann::json;

namespace {

constexpr std::size_t kMaxUnit = 15;  // bytes, as in plugin.h
constexpr std::size_t kMaxWord = 100;

[[noreturn]] void fail(const std::string& what) { throw ModelError(what); }

/// What nlohmann's exceptions say, without their own prefix "[json.exception...] ".
std::string reason(const Json::exception& e) {
  const std::string what = e.what();
  const std::size_t end = what.find("] ");
  return printable_line(end == what.npos ? what : what.substr(end + 2));
}

double number(const Json& in, const char* key) {
  const auto at = in.find(key);
  if (at == in.end()) fail(std::string("its description has no \"") + key + "\"");
  if (!at->is_number()) fail(std::string("\"") + key + "\" must be a number");
  return at->get<double>();
}

double number(const Json& in, const char* key, double default_value) {
  return in.contains(key) ? number(in, key) : default_value;
}

std::string text(const Json& in, const char* key, std::size_t limit) {
  const auto at = in.find(key);
  if (at == in.end()) return "";
  if (!at->is_string()) fail(std::string("\"") + key + "\" must be a text");
  const std::string value = at->get<std::string>();
  if (value.size() > limit)
    fail(std::string("\"") + key + "\" has more than " + std::to_string(limit) + " bytes");
  return printable_line(value);
}

const Json& array(const Json& in, const char* key) {
  static const Json none = Json::array();
  const auto at = in.find(key);
  if (at == in.end()) return none;
  if (!at->is_array()) fail(std::string("\"") + key + "\" must be an array");
  return *at;
}

void only_keys(const Json& in, const std::string& where,
               std::initializer_list<std::string_view> known) {
  for (const auto& [key, value] : in.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string names;
    for (const std::string_view k : known) names += (names.empty() ? "" : ", ") + std::string(k);
    fail("unknown key \"" + printable_line(key) + "\" in " + where + " (known: " + names + ")");
  }
}

Sphere read_sphere(const Json& in) {
  if (!in.is_object()) fail("\"spheres\" must be an array of objects");
  only_keys(in, "a sphere", {"radius", "colour", "label"});
  Sphere sphere;
  sphere.radius = static_cast<float>(number(in, "radius"));
  if (!std::isfinite(sphere.radius) || sphere.radius < 0)
    fail("a sphere whose radius is negative or too large");
  const Json& colour = array(in, "colour");
  if (!colour.empty() && colour.size() != 3) fail("a sphere's \"colour\" has three numbers");
  sphere.colour = {0.8F, 0.8F, 0.8F};
  for (std::size_t i = 0; i < colour.size(); ++i) {
    if (!colour[i].is_number()) fail("a sphere's \"colour\" has three numbers");
    const double c = colour[i].get<double>();
    if (!(c >= 0 && c <= 1)) fail("a sphere's colour is not within 0 and 1");
    sphere.colour[i] = static_cast<float>(c);
  }
  sphere.label = text(in, "label", kMaxLabelSize);
  return sphere;
}

Description describe(const Json& in) {
  if (!in.is_object()) fail("its first line is no JSON object");
  if (in.contains("error")) throw RefusedError(text(in, "error", std::string::npos));
  const auto version = in.find("hapgrid");
  if (version == in.end()) fail("its first line has no \"hapgrid\", the version of the protocol");
  if (!version->is_number_integer() || *version != kProtocolVersion)
    fail("it speaks version " + printable_line(version->dump(-1, ' ', true)) +
         " of the protocol, this hapgrid speaks " + std::to_string(kProtocolVersion));
  only_keys(in, "its description",
            {"hapgrid", "state_size", "d_max", "tolerance", "tolerance_unit", "norm", "weights",
             "length_unit", "energy_unit", "force_scale", "hip_radius", "stored", "spheres"});
  Description d;
  const double size = number(in, "state_size");
  if (!(size >= 1 && size <= kMaxStateSize) || size != std::floor(size))
    fail("\"state_size\" must be a whole number from 1 to " + std::to_string(kMaxStateSize));
  d.state_size = static_cast<std::uint32_t>(size);
  d.d_max = number(in, "d_max");
  if (!(d.d_max > 0)) fail("\"d_max\" must be positive");
  d.tolerance = number(in, "tolerance");
  if (!(d.tolerance >= 0)) fail("\"tolerance\" must not be negative");
  d.tolerance_unit = text(in, "tolerance_unit", kMaxUnit);
  d.length_unit = text(in, "length_unit", kMaxUnit);
  d.energy_unit = text(in, "energy_unit", kMaxUnit);
  d.force_scale = number(in, "force_scale", 0);
  d.hip_radius = number(in, "hip_radius", 0);
  if (!(d.hip_radius >= 0)) fail("\"hip_radius\" must not be negative");

  const std::string norm = in.contains("norm") ? text(in, "norm", kMaxWord) : "max";
  if (norm != "max" && norm != "rms") fail("\"norm\" must be \"max\" or \"rms\"");
  d.equality.norm = norm == "max" ? Equality::Norm::kMax : Equality::Norm::kRms;
  for (const Json& weight : array(in, "weights")) {
    if (!weight.is_number()) fail("\"weights\" must be an array of numbers");
    d.equality.weights.push_back(weight.get<double>());
  }
  if (!d.equality.fits(d.state_size))
    fail("\"weights\" must be " + std::to_string(d.state_size) +
         " numbers, one a component of the state, none of them negative");

  for (const Json& kept : array(in, "stored")) {
    const std::string what = kept.is_string() ? kept.get<std::string>() : "";
    if (what == "force") {
      d.stored.force = true;
    } else if (what == "energy") {
      d.stored.energy = true;
    } else if (what == "shape") {
      d.stored.shape = true;
    } else {
      fail("\"stored\" must be an array of \"force\", \"energy\" and \"shape\"");
    }
  }
  const Json& spheres = array(in, "spheres");
  if (spheres.size() > kMaxSpheres)
    fail("a shape of " + std::to_string(spheres.size()) + " spheres; " +
         std::to_string(kMaxSpheres) + " are possible");
  if (d.stored.shape == spheres.empty())
    fail("\"spheres\" and the \"shape\" in \"stored\" go together");
  for (const Json& sphere : spheres) d.spheres.push_back(read_sphere(sphere));
  return d;
}

}  // namespace

std::string handshake_line(const std::vector<Parameter>& parameters) {
  Json all = Json::object();
  for (const Parameter& p : parameters) {
    const auto require_finite = [&p](double number) {
      if (!std::isfinite(number))
        fail("parameter " + printable_line(p.key) + " is not finite, which JSON cannot say");
    };
    if (const auto* one = std::get_if<double>(&p.value)) require_finite(*one);
    if (const auto* many = std::get_if<std::vector<double>>(&p.value))
      std::for_each(many->begin(), many->end(), require_finite);
    all[p.key] = std::visit([](const auto& value) { return Json(value); }, p.value);
  }
  try {
    return Json{{"hapgrid", kProtocolVersion}, {"parameters", std::move(all)}}.dump() + "\n";
  } catch (const Json::exception&) {
    fail("a parameter's text is no UTF-8, which JSON cannot say");
  }
}

Description read_description(std::string_view line) {
  Json in;
  try {
    in = Json::parse(line);
  } catch (const Json::exception& e) {
    fail("its first line is no JSON: " + reason(e));
  }
  return describe(in);
}

}  // namespace hapgrid
