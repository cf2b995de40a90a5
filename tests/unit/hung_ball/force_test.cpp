
#include "tests/unit/catch.hpp"
#include "tests/unit/hung_ball/reference.hpp"

using namespace hapgrid;
using namespace hung_ball;

namespace {

constexpr double kWeight = 2.5;
constexpr double kMaxForce = 4;

std::unique_ptr<Model> heavy() { return make({{"weight", kWeight}, {"max_force", kMaxForce}}); }

}  // namespace

TEST_CASE("the energy is the ball's height; check-model compares the force with it") {
  const auto model = heavy();
  walk(*model, kRadius, 7, 50000, 0.1, [&](double alpha, const Vec3& x, const Vec3& d) {
    const double reached = convert(*model, alpha, x, d);
    const Real gained = kWeight * (1 - std::cos(Real{reached}));
    // Five roundings of the model, one of the cosine.
    CHECK(std::abs(model->energy(x + d, &reached) - gained) <=
          8 * kU * gained + kWeight * 0x1p-63L);
  });
}

TEST_CASE("the force is finite and bounded, whatever the state; it is 0 at rest only") {
  const auto model = heavy();
  walk(*model, kRadius, 8, 20000, model->info().d_max,
       [&](double alpha, const Vec3& x, const Vec3& d) {
         const Vec3 p = x + d;
         const double reached = convert(*model, alpha, x, d);
         const Vec3 f = model->force(p, &reached);
         const double size = length_of(f);
         CHECK(size <= kMaxForce * (1 + 4 * kU));
         CHECK((size == 0) == (reached == 0));
         // It points from the ball to the HIP.
         const Vec3 u{std::sin(reached) - p[0], -p[1], 1 - std::cos(reached) - p[2]};
         if (size > 0) CHECK(dot(f, u) == Approx(-size * length_of(u)).epsilon(1e-12));
       });

  Random random(9);
  const double nan = std::nan("");
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<double> states{nan, inf, -inf, 1e300, -1e300, 5e-324, 0, 3.2, -3.2};
  for (int i = 0; i < 1000; ++i) states.push_back(random.between(-10, 10));
  for (const double state : states) {
    std::vector<Vec3> places{{0, 0, 0},     {std::sin(state), 0, 1 - std::cos(state)},
                             {1e200, 0, 0}, {nan, 0, 0},
                             {0, inf, 0},   {0, 0, 1}};
    for (int i = 0; i < 100; ++i) places.push_back(random.point());
    for (const Vec3& p : places) {
      CHECK(length_of(model->force(p, &state)) <= kMaxForce * (1 + 4 * kU));
    }
  }
}

TEST_CASE("the shape is the ball where the state has it, and its rope") {
  const auto model = make();
  const std::vector<Sphere> spheres = model->info().spheres;
  REQUIRE(spheres.size() == 49);
  CHECK(spheres[0].radius == 0.1F);
  std::vector<float> centres(3 * spheres.size());
  for (const double alpha : {0.0, 0.3, -0.7, 2.0}) {
    model->shape({}, &alpha, centres);
    // float has 2^-24; all coordinates are below 2.
    const double bound = 2 * 0x1p-24;
    CHECK(std::abs(centres[0] - std::sin(alpha)) <= bound);
    CHECK(centres[1] == 0);
    CHECK(std::abs(centres[2] - (1 - std::cos(alpha))) <= bound);
    CHECK(centres[3] == 0);
    CHECK(centres[5] == 1);
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      for (const float c : spheres[i].colour) CHECK((c >= 0 && c <= 1));
      if (i == 0) continue;
      // The beads are between the hinge and the ball, on the rope.
      const double x = centres[3 * i];
      const double w = 1 - centres[3 * i + 2];
      CHECK(std::abs(x * std::cos(alpha) - w * std::sin(alpha)) <= 2 * bound);
      CHECK(std::hypot(x, w) < 1);
      CHECK(spheres[i].radius < spheres[0].radius);
    }
  }
}
