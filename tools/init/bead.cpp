// A model in C++: a bead between two wells, pulled by a spring. Put your own in place of Bead;
// <hapgrid/plugin.hpp> says which functions it may have, and plugin.h what each of them must
// do.
//
// The bead slides on a rail along x and rests in one of two wells. The HIP pulls it by a spring
// that weakens with the HIP's distance from the rail. The state s is the bead's place, in mm. With
// the HIP at (x, y, z) and q = y^2 + z^2,
//
//   E = b/4 (s^2 - a^2)^2 + k(q)/2 (x - s)^2      k(q) = k0 / (1 + q/R^2)
//   dE/ds = 0:  s^3 + P s - Q = 0                 P = k/b - a^2,  Q = k/b x
//
// There are two stable roots, one on each side of 0, or a single one. So the bead remembers
// only its side: the sign of s.
#include <cmath>
#include <hapgrid/plugin.hpp>
#include <stdexcept>
#include <vector>

namespace {

class Bead {
 public:
  static constexpr int kStateSize = 1;

  // The parameters of the definition, with their defaults.
  explicit Bead(hapgrid::PluginParameters& parameters)
      : wells_(parameters.positive("wells", 10)),
        depth_(parameters.positive("depth", 5)),
        stiffness_(parameters.positive("stiffness", 0.25)),
        reach_(parameters.positive("reach", 10)),
        strength_(parameters.positive("strength", 60)),
        tolerance_(parameters.positive("tolerance", 1e-6)),
        b_(4 * depth_ / std::pow(wells_, 4)) {
    parameters.finish();
  }

  hapgrid_model_info info() const {
    hapgrid_model_info info{};
    info.state_size = kStateSize;
    info.d_max = reach_;
    info.tolerance = tolerance_;
    std::snprintf(info.tolerance_unit, sizeof info.tolerance_unit, "mm");
    std::snprintf(info.length_unit, sizeof info.length_unit, "mm");
    std::snprintf(info.energy_unit, sizeof info.energy_unit, "N mm");
    info.force_scale = 1;
    info.spheres = 3;
    return info;
  }

  // What the search starts from, in the corners of the box: a state for each side, or a single one.
  std::vector<double> known_states(const double* x) const {
    const double left = settle(x, false), right = settle(x, true);
    return left < 0 && right > 0 ? std::vector{left, right} : std::vector{left};
  }

  // C(s, x, d): the HIP walks from x to x + d in steps that are short against the reach of the
  // spring.
  void convert(const double* s, const double* x, const double* d, double* result) {
    const double steps = std::ceil(std::hypot(d[0], d[1], d[2]) / (reach_ / 64));
    *result = *s;
    for (double step = 1; step <= steps; ++step) {
      const double f = step / steps;
      const double hip[] = {x[0] + f * d[0], x[1] + f * d[1], x[2] + f * d[2]};
      *result = settle(hip, *result >= 0);
      if (std::hypot(hip[0] - *result, hip[1], hip[2]) > strength_)
        throw std::runtime_error("the spring broke: it is longer than its strength");
    }
  }

  bool equal(const double* a, const double* b) const {
    for (int k = 0; k < kStateSize; ++k)
      if (!(std::abs(a[k] - b[k]) <= tolerance_)) return false;
    return true;
  }

  // -dE/dx, in newtons.
  void force(const double* x, const double* s, double* force) const {
    const double k = spring(x), u = x[0] - *s;
    const double sideways = u * u * k * k / (stiffness_ * reach_ * reach_);  // -k'(q) u^2
    force[0] = -k * u;
    force[1] = sideways * x[1];
    force[2] = sideways * x[2];
  }

  double energy(const double* x, const double* s) const {
    const double well = *s * *s - wells_ * wells_, u = x[0] - *s;
    return b_ / 4 * well * well + spring(x) / 2 * u * u;
  }

  // What a viewer shows: the bead, and the two wells.
  void spheres(hapgrid_sphere* spheres) const {
    spheres[0] = {static_cast<float>(wells_ / 5), {0.9F, 0.9F, 0.3F}, ""};
    spheres[1] = spheres[2] = {static_cast<float>(wells_ / 20), {0.4F, 0.4F, 0.9F}, ""};
  }
  void shape(const double* s, float* centres) const {
    const double along[] = {*s, -wells_, wells_};
    for (int i = 0; i < 3; ++i) {
      centres[3 * i] = static_cast<float>(along[i]);
      centres[3 * i + 1] = centres[3 * i + 2] = 0;
    }
  }

 private:
  double spring(const double* x) const {
    return stiffness_ / (1 + (x[1] * x[1] + x[2] * x[2]) / (reach_ * reach_));
  }

  // The bead's place with the HIP at x when it comes from that side. Your equations go here.
  double settle(const double* x, bool right) const {
    const double k = spring(x) / b_;
    const double p = (k - wells_ * wells_) / 3, q = k * x[0] / 2;  // a third of P, half of Q
    const double d = q * q + p * p * p;
    if (d < 0) {  // two stable roots
      const double root =
          2 * std::sqrt(-p) * std::cos(std::acos((right ? q : -q) / std::sqrt(-p * p * p)) / 3);
      return right ? root : -root;
    }
    // Cardano's formula u - p/u, written so that nothing cancels.
    const double u = std::cbrt(std::abs(q) + std::sqrt(d));
    return u > 0 ? 2 * q / (u * u + p + p / u * (p / u)) : 0;
  }

  double wells_, depth_, stiffness_, reach_, strength_, tolerance_;
  double b_;  // N/mm^3
};

}  // namespace

HAPGRID_MODEL_PLUGIN(Bead, "a bead between two wells, pulled by a spring (C++)")
