// Force, energy and shape while a grid is played: interpolated from what the grid stores with its
// states (Sect. 2.2 of the paper), or evaluated by the model where the grid stores nothing.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "libcore/model/model.hpp"

namespace hapgrid {

/// For one thread. A row is what the player interpolates: spec.row_size() numbers, the state first.
class Fields {
 public:
  /// @param spec outlives this.
  /// @param create makes the model; called only where the force, or a wanted shape, is not stored.
  /// @throw ModelError when there is no force: the model has none, or it is a process, for which no
  /// haptic loop can wait; when the model is not the grid's; what `create` throws.
  Fields(const GridSpec& spec, const MakeModel& create, bool wants_shape);
  /// For a model that is there. It may have no force.
  /// @param spec, model outlive this.
  Fields(const GridSpec& spec, const Model& model);

  bool has_force() const { return spec_.stored.force || asks_for_force(); }
  bool has_energy() const { return spec_.stored.energy || (model_ && model_->has_energy()); }
  /// Whether the model evaluates them, because the grid does not store them.
  bool asks_for_force() const { return !spec_.stored.force && model_ && model_->has_force(); }
  bool asks_for_shape() const { return !spec_.stored.shape && model_ && model_->has_shape(); }
  /// Newtons that one unit of energy per unit of length is; 0 where it is not known.
  double force_scale() const { return model_ ? model_->info().force_scale : spec_.force_scale; }
  bool has_own_energy() const { return model_ && model_->has_own_energy(); }
  /// Torsions of the spheres; empty where a grid that stores its shape is played without a model.
  std::vector<Torsion> torsions() const {
    return model_ && !spheres_.empty() ? model_->info().torsions : std::vector<Torsion>();
  }
  /// The spheres of shape(); empty where there is no shape.
  const std::vector<Sphere>& spheres() const { return spheres_; }

  /// F(x, s) in newtons; needs has_force(). Real-time safe, as far as the model is.
  Vec3 force(const Vec3& x, std::span<const double> row) const noexcept;
  /// In the model's unit; needs has_energy(). Real-time safe, as far as the model is.
  double energy(const Vec3& x, std::span<const double> row) const noexcept;
  /// The same of the model by itself, without the HIP; needs has_own_energy().
  double own_energy(std::span<const double> row) const noexcept {
    return model_->own_energy(row.data());
  }
  /// Centres of the spheres with the HIP at x, x y z by sphere. Real-time safe, as far as the model
  /// is.
  void shape(const Vec3& x, std::span<const double> row, std::span<float> centres) const noexcept;

 private:
  const GridSpec& spec_;
  std::unique_ptr<Model> own_model_;
  const Model* model_ = nullptr;
  std::vector<Sphere> spheres_;
};

}  // namespace hapgrid
