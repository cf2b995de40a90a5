// The paper's own example (Fig. 1, Table 1) in a 3D box: a ball of radius r hangs on a rope of
// length 1 from a hinge at (0, 0, 1) and swings in the xz-plane; the HIP is a ball of the same
// radius at p = (x, y, z) that pushes it. The state is the angle α of the rope, the ball's centre
// is c(α) = (sin α, 0, 1 - cos α).
//
// About the hinge, p is at the distance ρ and the angle φ = atan2(x, 1 - z). With m = 4r² - y² the
// balls would overlap for |α - φ| < δ, cos δ = (1 + ρ² - m) / (2ρ); there is no such arc when m <=
// 0 or the quotient is >= 1. A ball right of the HIP (α >= φ) settles at max(0, φ + δ), one left of
// it at min(0, φ - δ), and at 0 where there is no arc or the contact angle reaches ±π.
//
// Written with angles this costs three transcendental functions a substep, acos loses half of its
// digits near the tear-off, and α, φ and φ ± δ each have a branch to wrap. So C compares directions
// from the hinge as vectors (sine, cosine) of any positive length, and takes one atan2 at the end:
//
//   e = ρ² - 1 = x² + z (z - 2)      w = 1 - z
//   (2ρ sin δ)² = 4ρ² - (1 + ρ² - m)² = 4m - (e - m)²     (the right side has little to cancel)
//   2ρ cos δ = 2 + e - m
//   2ρ² sin(φ ± δ) = x 2ρ cos δ ± w 2ρ sin δ
//   2ρ² cos(φ ± δ) = w 2ρ cos δ ∓ x 2ρ sin δ
//
// There is an arc when 4m - (e - m)² > 0, which m <= 0 never reaches. As r < 1/2, m < 1 and so
// 0 < δ < π/2, hence φ + δ lies in (-π, 3π/2), and "φ + δ <= 0 or φ + δ >= π", the two ways to
// settle at 0 on the right, is sin(φ + δ) <= 0. On the left it is sin(φ - δ) >= 0. All states
// reached therefore lie in (-π, π) and none overlaps the HIP.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <hapgrid/plugin.hpp>
#include <stdexcept>
#include <vector>

#include "examples/parameters.hpp"

namespace {

using hapgrid::decimal;
using hapgrid::finite_number;
using hapgrid::refuse;

class HungBall {
 public:
  explicit HungBall(hapgrid::PluginParameters& parameters)
      : radius_(finite_number(parameters, "radius", 0.1)),
        weight_(finite_number(parameters, "weight", 1)),
        max_force_(finite_number(parameters, "max_force", 3)),
        tolerance_(finite_number(parameters, "tolerance", 1e-6)),
        stored_(parameters.boolean("stored", false)) {
    parameters.finish();
    if (!(radius_ > 0 && radius_ < 0.5)) refuse("radius", radius_, "above 0 and below 0.5");
    if (!(weight_ > 0)) refuse("weight", weight_, "positive");
    if (!(max_force_ > 0)) refuse("max_force", max_force_, "positive");
    if (!(tolerance_ >= 0)) refuse("tolerance", tolerance_, "0 or more");
    substep_ = radius_ / 16;
    d_max_ = 2 * std::sqrt(radius_ * (radius_ + 1)) - 2 * radius_;
  }

  hapgrid_model_info info() const {
    hapgrid_model_info info{};
    info.state_size = 1;
    info.d_max = d_max_;
    info.tolerance = tolerance_;
    std::snprintf(info.tolerance_unit, sizeof info.tolerance_unit, "rad");
    std::snprintf(info.length_unit, sizeof info.length_unit, "rope lengths");
    std::snprintf(info.energy_unit, sizeof info.energy_unit, "N rope lengths");
    info.force_scale = 1;
    info.hip_radius = radius_;
    if (stored_) info.stored = HAPGRID_STORE_FORCE | HAPGRID_STORE_ENERGY | HAPGRID_STORE_SHAPE;
    info.spheres = 1 + kBeads;
    return info;
  }

  /// The ball at rest, wherever it does not overlap the HIP.
  std::vector<double> known_states(const double* p) const {
    const double distance_squared = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    if (distance_squared >= 4 * radius_ * radius_) return {0};
    return {};
  }

  /// The HIP walks in substeps: only after a move that is short against the balls is it certain on
  /// which side of the HIP the ball is.
  void convert(const double* s, const double* x, const double* d, double* result) const {
    const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    // A d of length d_max may have been rounded up: hence the slack.
    if (!(length <= d_max_ * (1 + 1e-9)))
      throw std::runtime_error("a shift of " + decimal(length) + ", d_max is " + decimal(d_max_));
    const double substeps = std::ceil(length / substep_);
    if (substeps == 0) {
      result[0] = s[0];
      return;
    }
    // Where there is no arc at the end, the ball hangs at 0 whatever happened before. Most calls
    // end here.
    const double end[3] = {x[0] + d[0], x[1] + d[1], x[2] + d[2]};
    if (!Arc(end, radius_).exists()) {
      result[0] = 0;
      return;
    }
    Rope rope{std::sin(s[0]), std::cos(s[0])};
    for (double k = 1; k <= substeps; ++k) {
      const double f = k / substeps;
      const double p[3] = {x[0] + f * d[0], x[1] + f * d[1], x[2] + f * d[2]};
      rope = Arc(p, radius_).settle(rope);
    }
    result[0] = std::atan2(rope.sine, rope.cosine);
  }

  bool equal(const double* a, const double* b) const { return std::abs(a[0] - b[0]) <= tolerance_; }

  /// The HIP pushes the ball with N along u = (c - p) / |c - p|. Along the ball's path, which has
  /// the tangent τ, N u·τ balances the weight W sin α; the HIP feels -N u. At the tear-off u·τ goes
  /// to 0, and max_force bounds N. In a state that is a blend of two branches the weight can press
  /// the ball away from the HIP: then there is no force.
  void force(const double* p, const double* s, double* f) const {
    f[0] = f[1] = f[2] = 0;
    if (s[0] == 0) return;  // most states of a grid: the ball hangs freely
    const double sine = std::sin(s[0]);
    const double cosine = std::cos(s[0]);
    const double u[3] = {sine - p[0], -p[1], 1 - cosine - p[2]};  // times |c - p|
    const double distance = std::hypot(u[0], u[1], u[2]);
    const double along = (u[0] * cosine + u[2] * sine) / distance;
    if (!(along * sine > 0))
      return;  // true as well for a state that is not a number, and for c = p
    const double pushed = std::min(max_force_, weight_ * sine / along);
    for (int a = 0; a < 3; ++a) f[a] = -pushed * u[a] / distance;
  }

  /// The weight times the height that the ball has gained. There is no friction, so this is the
  /// work of the HIP.
  double energy(const double*, const double* s) const {
    if (s[0] == 0) return 0;  // as in force()
    const double half = std::sin(s[0] / 2);
    return weight_ * 2 * half * half;
  }

  /// The first sphere is the ball; the others are beads that show the rope from the hinge down.
  void spheres(hapgrid_sphere* spheres) const {
    for (unsigned i = 0; i <= kBeads; ++i)
      spheres[i] = {static_cast<float>(i == 0 ? radius_ : radius_ / 8), {0.9F, 0.9F, 0.9F}, ""};
    spheres[0].colour[2] = 0.3F;
  }
  void shape(const double* s, float* centres) const {
    const double sine = std::sin(s[0]);
    const double cosine = std::cos(s[0]);
    for (unsigned i = 0; i <= kBeads; ++i) {
      const double along = i == 0 ? 1 : (i - 1.0) / kBeads;
      centres[3 * i] = static_cast<float>(along * sine);
      centres[3 * i + 1] = 0;
      centres[3 * i + 2] = static_cast<float>(1 - along * cosine);
    }
  }

 private:
  static constexpr unsigned kBeads = 48;  // so close that they touch

  /// The direction of the rope from the hinge: sin α and cos α times any positive factor.
  struct Rope {
    double sine, cosine;
  };

  /// The angles at which the ball would overlap a HIP at p. The symbols are explained at the top of
  /// this file.
  class Arc {
   public:
    Arc(const double* p, double radius) : x_(p[0]), w_(1 - p[2]) {
      const double m = (2 * radius - p[1]) * (2 * radius + p[1]);
      const double e = p[0] * p[0] + p[2] * (p[2] - 2);
      sine_squared_ = 4 * m - (e - m) * (e - m);
      cosine_ = 2 + e - m;
    }
    bool exists() const { return sine_squared_ > 0; }

    /// Where the ball settles when it hung at `rope` before the HIP's last small move.
    Rope settle(const Rope& rope) const {
      constexpr Rope kRest{0, 1};
      if (!exists()) return kRest;
      const double sine = std::sqrt(sine_squared_);
      if (right(rope)) {
        const Rope contact{x_ * cosine_ + w_ * sine, w_ * cosine_ - x_ * sine};
        return contact.sine > 0 ? contact : kRest;
      }
      const Rope contact{x_ * cosine_ - w_ * sine, w_ * cosine_ + x_ * sine};
      return contact.sine < 0 ? contact : kRest;
    }

   private:
    /// Whether α >= φ, both in (-π, π]. For angles of one sign this is the sign of sin(α - φ), and
    /// φ has the sign of x. One case is left open: α = 0 with the HIP straight above the hinge.
    /// There the ball settles at 0 on either side.
    bool right(const Rope& rope) const {
      const bool ahead = rope.sine * w_ - rope.cosine * x_ >= 0;
      return rope.sine >= 0 ? x_ < 0 || ahead : x_ < 0 && ahead;
    }

    double x_, w_;
    double sine_squared_;  // (2ρ sin δ)²
    double cosine_;        // 2ρ cos δ
  };

  double radius_;     // r, in rope lengths
  double weight_;     // W, newtons
  double max_force_;  // newtons
  double tolerance_;  // radians
  bool stored_;       // whether the grid keeps force, energy and shape; tests compare both ways
  double substep_;    // of convert(), at most, in rope lengths
  double d_max_;      // t - 2r, in rope lengths: Table 1 holds for shifts up to this
};

}  // namespace

HAPGRID_MODEL_PLUGIN(HungBall, "a ball that hangs on a rope and is pushed by another ball")
