// The plug-in around block.hpp: its parameters, its states, and what a grid stores with them
// (README.md).
//
// A state is the displacement of all free nodes. The haptic loop has no time to sum a force over so
// large a surface, so force, energy and shape are stored with each state.
#include <cmath>
#include <cstdio>
#include <hapgrid/plugin.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "examples/parameters.hpp"
#include "examples/soft-tissue/block.hpp"

namespace {

using hapgrid::decimal;
using hapgrid::finite_number;
using hapgrid::refuse;
using soft_tissue::Block;
using soft_tissue::Vec3;
using soft_tissue::Vector;

class SoftTissue {
 public:
  explicit SoftTissue(hapgrid::PluginParameters& parameters) {
    soft_tissue::Options& o = options_;
    const std::vector<double> size = triple(parameters, "size", {72, 72, 18});
    const std::vector<double> elements = triple(parameters, "elements", {12, 12, 3});
    o.young_modulus = kPa * finite_number(parameters, "young_modulus", 6);
    o.poisson_ratio = finite_number(parameters, "poisson_ratio", 0.4);
    o.probe_radius = finite_number(parameters, "probe_radius", 15);
    o.contact_stiffness = kPa * finite_number(parameters, "contact_stiffness", 20);
    o.contact_smoothing = finite_number(parameters, "contact_smoothing", 0.5);
    o.adhesion = kPa * finite_number(parameters, "adhesion", 4);
    o.adhesion_range = finite_number(parameters, "adhesion_range", 2);
    substep_ = finite_number(parameters, "substep", 1.5);
    tolerance_ = finite_number(parameters, "tolerance", 0.01);
    parameters.finish();
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const int step = axis < 2 ? 2 : 1;
      if (!(size[a] > 0)) refuse("size", size[a], "positive");
      if (!(elements[a] >= step && elements[a] <= 100 && std::fmod(elements[a], step) == 0))
        refuse("elements", elements[a],
               axis < 2 ? "an even number from 2 to 100 along x and y"
                        : "a whole number from 1 to 100 along z");
      o.size[a] = size[a];
      o.elements[a] = static_cast<int>(elements[a]);
    }
    if (!(o.young_modulus > 0)) refuse("young_modulus", o.young_modulus / kPa, "positive");
    // Linear tetrahedra lock when the material keeps its volume.
    if (!(o.poisson_ratio >= 0 && o.poisson_ratio <= 0.45))
      refuse("poisson_ratio", o.poisson_ratio, "from 0 to 0.45");
    if (!(o.probe_radius > 0)) refuse("probe_radius", o.probe_radius, "positive");
    if (!(o.contact_stiffness > 0))
      refuse("contact_stiffness", o.contact_stiffness / kPa, "positive");
    if (!(o.contact_smoothing > 0)) refuse("contact_smoothing", o.contact_smoothing, "positive");
    if (!(o.adhesion_range > 0)) refuse("adhesion_range", o.adhesion_range, "positive");
    // At the touch the pull ends with the slope 27/4 adhesion / range. The pressure goes on from
    // there and may only become stiffer.
    const double most = 4.0 / 27 * o.contact_stiffness * o.adhesion_range;
    if (!(o.adhesion >= 0 && o.adhesion <= most))
      refuse("adhesion", o.adhesion / kPa,
             "from 0 to 4/27 contact_stiffness adhesion_range, " + decimal(most / kPa));
    if (!(substep_ > 0)) refuse("substep", substep_, "positive");
    if (!(tolerance_ >= 0)) refuse("tolerance", tolerance_, "0 or more");
    block_ = std::make_unique<Block>(o);
    u_.setZero(static_cast<Eigen::Index>(block_->unknowns()));
  }

  hapgrid_model_info info() const {
    hapgrid_model_info info{};
    info.state_size = static_cast<std::uint32_t>(block_->unknowns());
    info.stored = HAPGRID_STORE_FORCE | HAPGRID_STORE_SHAPE | HAPGRID_STORE_ENERGY;
    info.d_max = options_.probe_radius;
    info.tolerance = tolerance_;
    std::snprintf(info.tolerance_unit, sizeof info.tolerance_unit, "mm");
    std::snprintf(info.length_unit, sizeof info.length_unit, "mm");
    std::snprintf(info.energy_unit, sizeof info.energy_unit, "N mm");
    info.force_scale = 1;
    info.hip_radius = options_.probe_radius;
    info.spheres = static_cast<std::uint32_t>(block_->surface().size());
    return info;
  }

  /// The block at rest is known wherever the ball neither touches nor attracts it.
  std::vector<double> known_states(const double* x) const {
    if (!block_->is_clear(Vec3(x))) return {};
    return std::vector<double>(block_->unknowns(), 0.0);
  }

  void convert(const double* s, const double* x, const double* d, double* result) {
    u_ = Eigen::Map<const Vector>(s, u_.size());
    block_->follow(u_, Vec3(x), Vec3(x) + Vec3(d), substep_);
    Eigen::Map<Vector>(result, u_.size()) = u_;
  }

  /// Two states are equal when no node's places are farther apart than the tolerance.
  bool equal(const double* a, const double* b) const {
    const double most = tolerance_ * tolerance_;
    for (std::size_t i = 0; i < block_->unknowns(); i += 3) {
      const double x = a[i] - b[i], y = a[i + 1] - b[i + 1], z = a[i + 2] - b[i + 2];
      if (!(x * x + y * y + z * z <= most)) return false;
    }
    return true;
  }

  void force(const double* x, const double* s, double* f) {
    u_ = Eigen::Map<const Vector>(s, u_.size());
    Eigen::Map<Vec3>{f} = block_->force(u_, Vec3(x));
  }

  double energy(const double* x, const double* s) {
    u_ = Eigen::Map<const Vector>(s, u_.size());
    return block_->energy(u_, Vec3(x), gradient_);
  }

  /// Balls below the nodes of the free surface, which each of them touches from inside: large
  /// enough that together they look like one skin.
  void spheres(hapgrid_sphere* spheres) const {
    for (std::size_t i = 0; i < block_->surface().size(); ++i)
      spheres[i] = {static_cast<float>(skin()), {0.85F, 0.45F, 0.4F}, ""};
  }
  void shape(const double* s, float* centres) const {
    for (const std::size_t node : block_->surface()) {
      const Vec3 rest = block_->rest(node);
      for (int a = 0; a < 3; ++a) {
        const double half = options_.size[a] / 2, way = a < 2 ? rest[a] : rest[a] - half;
        const double inside = std::abs(way) > half - 1e-9 * half ? std::copysign(skin(), way) : 0;
        *centres++ =
            static_cast<float>(rest[a] + s[3 * node + static_cast<std::size_t>(a)] - inside);
      }
    }
  }

 private:
  /// Radius of the balls: the least thickness that the block has, or what closes the gaps.
  double skin() const {
    double edge = 0, least = options_.size[2] / 2;
    for (std::size_t a = 0; a < 3; ++a) {
      edge = std::max(edge, options_.size[a] / options_.elements[a]);
      least = std::min(least, options_.size[a] / 2);
    }
    return std::min(1.25 * edge, least);
  }

  static constexpr double kPa = 1e-3;  // N/mm^2

  static std::vector<double> triple(hapgrid::PluginParameters& parameters, const char* key,
                                    const std::vector<double>& value) {
    std::vector<double> given = parameters.numbers(key);
    if (given.empty()) return value;
    if (given.size() != 3)
      throw std::runtime_error(std::string("parameter ") + key + " has " +
                               std::to_string(given.size()) + " numbers, it needs 3");
    for (const double x : given)
      if (!std::isfinite(x)) refuse(key, x, "finite");
    return given;
  }

  soft_tissue::Options options_;
  double substep_ = 0;    // mm
  double tolerance_ = 0;  // mm
  std::unique_ptr<Block> block_;
  Vector u_, gradient_;  // workspace
};

}  // namespace

HAPGRID_MODEL_PLUGIN(SoftTissue, "a ball pokes into a block of soft tissue")
