// The bead between two wells, the same for the plug-in in C and the one in Fortran. The oracle is
// bisection in long double on dE/ds = b s (s^2 - a^2) + k (s - x), which has one root a branch.

#include "libcore/grid/vec3.hpp"
#include "libcore/model/plugin_model.hpp"
#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

using Real = long double;

constexpr double kWells = 10, kDepth = 5, kStiffness = 0.25, kReach = 10;  // the defaults
constexpr Real kB = 4 * Real{kDepth} / (Real{kWells} * kWells * kWells * kWells);

std::vector<std::unique_ptr<Model>> plugins() {
  std::vector<std::unique_ptr<Model>> models;
  models.push_back(Plugin("spring-c", {HAPGRID_BUILD_DIR "/models"}).create({}));
#ifdef HAPGRID_FORTRAN
  models.push_back(Plugin("spring-fortran", {HAPGRID_BUILD_DIR "/models"}).create({}));
#endif
  return models;
}

Real stiffness(const Vec3& p) {
  return kStiffness / (1 + (Real{p[1]} * p[1] + Real{p[2]} * p[2]) / (kReach * kReach));
}

/// |s| where the branch of a side ends: the root of the second derivative, 0 where there is one
/// branch.
Real fold(const Vec3& p) {
  const Real third = (Real{kWells} * kWells - stiffness(p) / kB) / 3;
  return third > 0 ? std::sqrt(third) : 0;
}

/// The stable state on a side; NaN when there is none.
Real state_on(const Vec3& p, bool right) {
  const Real k = stiffness(p);
  const auto slope = [&](Real s) { return kB * s * (s * s - kWells * kWells) + k * (s - p[0]); };
  Real low = right ? fold(p) : -100;
  Real high = right ? 100 : -fold(p);
  if (!(slope(low) <= 0 && slope(high) >= 0)) return std::nanl("");
  for (;;) {
    const Real middle = (low + high) / 2;
    if (middle == low || middle == high) return middle;
    (slope(middle) < 0 ? low : high) = middle;
  }
}

/// How far a state may be from the exact one. The model's P and Q are off by some u; the branch
/// magnifies this by 1 / (second derivative), and near a fold the error is its square root.
double bound(const Vec3& p, Real s) {
  const Real curvature = (3 * s * s - kWells * kWells) + stiffness(p) / kB;
  return static_cast<double>(std::min(Real{1e-5}, 1e-11L / std::max(curvature, Real{1e-9})) +
                             1e-12L);
}

double between(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

double convert(Model& model, double s, const Vec3& x, const Vec3& d) {
  double reached = 0;
  return model.convert(&s, x, d, &reached) ? reached : std::nan("");
}

}  // namespace

TEST_CASE("the known states are the stable ones") {
  for (const auto& model : plugins()) {
    std::mt19937_64 random(1);
    int two = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 p{between(random, -20, 20), between(random, -15, 15), between(random, -15, 15)};
      const std::vector<double> known = model->known_states(p);
      std::vector<Real> exact;
      for (const bool right : {false, true})
        if (const Real s = state_on(p, right); !std::isnan(s)) exact.push_back(s);
      // Random points do not meet a fold.
      REQUIRE(known.size() == exact.size());
      for (std::size_t j = 0; j < known.size(); ++j)
        CHECK(std::abs(known[j] - exact[j]) <= bound(p, exact[j]));
      two += known.size() == 2;
    }
    CHECK(two > 1000);
  }
}

TEST_CASE("off the rail the bead stays in its well until that is gone: hysteresis") {
  for (const auto& model : plugins()) {
    const double y = 14;
    const Vec3 start{-18, y, 0};
    const Real m = fold(start), end = 2 * kB / stiffness(start) * m * m * m;  // |x| at the fold
    REQUIRE(end > 1);
    for (const bool right : {false, true}) {
      const double d = right ? -0.25 : 0.25;
      double x = right ? 18 : -18;
      double s = model->known_states({x, y, 0})[0];
      for (int i = 0; i < 144; ++i, x += d) {
        s = convert(*model, s, {x, y, 0}, {d, 0, 0});
        const bool stays = right ? x + d > -end : x + d < end;
        CHECK((s > 0) == (stays == right));
        const Vec3 p{x + d, y, 0};
        const Real exact = state_on(p, s > 0);
        CHECK(std::abs(s - exact) <= bound(p, exact));
      }
    }
  }
}

TEST_CASE("on the rail the bead follows, and there and back around a fold it has changed wells") {
  for (const auto& model : plugins()) {
    Vec3 p{-6, 14, 0};
    double s = model->known_states(p)[0];
    REQUIRE(s < 0);
    for (const Vec3& to : {Vec3{-6, 0, 0}, Vec3{6, 0, 0}, Vec3{6, 14, 0}, Vec3{0, 14, 0}}) {
      const Vec3 d = 1.0 / 16 * (to - p);
      for (int i = 0; i < 16; ++i, p = p + d) {
        const double before = s;
        s = convert(*model, s, p, d);
        CHECK(std::abs(s - before) < 3);  // no snap
      }
    }
    CHECK(s > 5);
  }
}
