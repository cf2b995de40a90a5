#include "libcore/model/fields.hpp"

#include <algorithm>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

Fields::Fields(const GridSpec& spec, const MakeModel& create, bool wants_shape) : spec_(spec) {
  const bool is_process = spec.equality.is_declared();
  if (is_process && !spec.stored.force)
    throw ModelError(
        format("model {}: is a process, which is too slow for forces, and this grid stores none "
               "(\"stored\": [\"force\"])",
               spec.model));
  const bool shape_missing = wants_shape && !spec.stored.shape && !is_process;
  if (!spec.stored.force || shape_missing) {
    own_model_ = create();
    model_ = own_model_.get();
    if (model_->state_size() != spec.state_size)
      throw ModelError(format("model {}: states of {} values, the grid has {}", spec.model,
                              model_->state_size(), spec.state_size));
  }
  if (!has_force())
    throw ModelError(
        format("model {}: has no force function, forces cannot be computed", spec.model));
  if (spec.stored.shape)
    spheres_ = spec.spheres;
  else if (model_)
    spheres_ = model_->info().spheres;
}

Fields::Fields(const GridSpec& spec, const Model& model)
    : spec_(spec),
      model_(&model),
      spheres_(spec.stored.shape ? spec.spheres : model.info().spheres) {}

Vec3 Fields::force(const Vec3& x, std::span<const double> row) const noexcept {
  if (!spec_.stored.force) return model_->force(x, row.data());
  const double* f = row.data() + spec_.force_offset();
  return {f[0], f[1], f[2]};
}

double Fields::energy(const Vec3& x, std::span<const double> row) const noexcept {
  return spec_.stored.energy ? row[spec_.energy_offset()] : model_->energy(x, row.data());
}

void Fields::shape(const Vec3& x, std::span<const double> row,
                   std::span<float> centres) const noexcept {
  if (spec_.stored.shape)
    std::copy_n(row.data() + spec_.shape_offset(), centres.size(), centres.begin());
  else if (!spheres_.empty())
    model_->shape(x, row.data(), centres);
}

}  // namespace hapgrid
