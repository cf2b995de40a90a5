#include "libcore/grid/spec.hpp"

#include <sstream>

namespace hapgrid {

namespace {

template <class T>
std::string both(const char* what, const T& a, const T& b) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(17);
  out << what << ' ' << a << " and " << b;
  return out.str();
}

}  // namespace

std::string distance_unit(const GridSpec& spec) {
  return spec.equality.is_declared() || spec.state_size == 1 ? spec.tolerance_unit
                                                             : "of a component";
}

std::string difference(const GridSpec& a, const GridSpec& b) {
  static constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const std::string axis = kAxes[i];
    if (a.box.origin[i] != b.box.origin[i])
      return both(("origin " + axis).c_str(), a.box.origin[i], b.box.origin[i]);
    if (a.box.counts[i] != b.box.counts[i])
      return both(("count " + axis).c_str(), a.box.counts[i], b.box.counts[i]);
  }
  if (a.box.spacing != b.box.spacing) return both("spacing", a.box.spacing, b.box.spacing);
  if (a.model != b.model) return both("model", a.model, b.model);
  if (a.state_size != b.state_size) return both("state size", a.state_size, b.state_size);
  if (a.tolerance != b.tolerance) return both("tolerance", a.tolerance, b.tolerance);
  if (a.max_levels != b.max_levels) return both("level limit", a.max_levels, b.max_levels);
  if (a.parameters != b.parameters) {
    for (const Parameter& p : a.parameters) {
      for (const Parameter& other : b.parameters)
        if (p.key == other.key && !(p == other)) return "model parameter " + p.key;
    }
    return "the set of model parameters";
  }
  if (!(a.equality == b.equality)) return "the tolerance function";
  if (!(a.stored == b.stored)) return "what is stored with each state";
  if (a.spheres != b.spheres) return "the spheres that show the model";
  if (a.tears != b.tears) return "whether it has tear fractions";
  if (a.hip_radius != b.hip_radius) return both("radius of the HIP", a.hip_radius, b.hip_radius);
  if (a.force_scale != b.force_scale)
    return both("scale of the force", a.force_scale, b.force_scale);
  return a == b ? "" : "the units";
}

}  // namespace hapgrid
