#include "libcore/grid/spec.hpp"

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

std::string distance_unit(const GridSpec& spec) {
  return spec.equality.is_declared() || spec.state_size == 1 ? spec.tolerance_unit
                                                             : "of a component";
}

std::string difference(const ModelDescription& a, const ModelDescription& b) {
  if (a.state_size != b.state_size)
    return format("state size {} and {}", a.state_size, b.state_size);
  if (a.version != b.version)
    return format("version '{}' and '{}'", printable_line(a.version), printable_line(b.version));
  if (a.tolerance != b.tolerance)
    return format("tolerance {} and {}", to_text(a.tolerance), to_text(b.tolerance));
  if (a.equality != b.equality) return "the tolerance function";
  if (a.stored != b.stored) return "what is stored with each state";
  if (a.stored.shape && a.spheres != b.spheres) return "the spheres that show the model";
  if (a.hip_radius != b.hip_radius)
    return format("radius of the HIP {} and {}", to_text(a.hip_radius), to_text(b.hip_radius));
  if (a.force_scale != b.force_scale)
    return format("scale of the force {} and {}", to_text(a.force_scale), to_text(b.force_scale));
  const bool has_same_units = a.tolerance_unit == b.tolerance_unit &&
                              a.length_unit == b.length_unit && a.energy_unit == b.energy_unit;
  return has_same_units ? "" : "the units";
}

std::string difference(const GridSpec& a, const GridSpec& b) {
  if (a.model != b.model) return format("model {} and {}", a.model, b.model);
  for (int i = 0; i < 3; ++i) {
    if (a.box.origin[i] != b.box.origin[i])
      return format("origin {} {} and {}", "xyz"[i], to_text(a.box.origin[i]),
                    to_text(b.box.origin[i]));
    if (a.box.counts[i] != b.box.counts[i])
      return format("count {} {} and {}", "xyz"[i], a.box.counts[i], b.box.counts[i]);
  }
  if (a.box.spacing != b.box.spacing)
    return format("spacing {} and {}", to_text(a.box.spacing), to_text(b.box.spacing));
  if (a.max_levels != b.max_levels)
    return format("level limit {} and {}", a.max_levels, b.max_levels);
  if (a.parameters != b.parameters) {
    for (const Parameter& p : a.parameters)
      for (const Parameter& other : b.parameters)
        if (p.key == other.key && !(p == other)) return "model parameter " + p.key;
    return "the set of model parameters";
  }
  return difference(static_cast<const ModelDescription&>(a),
                    static_cast<const ModelDescription&>(b));
}

}  // namespace hapgrid
