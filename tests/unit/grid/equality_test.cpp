// Angles and orientations against closed forms.
#include "libcore/grid/equality.hpp"

#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTurn = 2 * kPi;

/// The first two columns of the turn by `angle` around z, then by `tilt` around x.
std::vector<double> turned(double angle, double tilt) {
  const double c = std::cos(angle), s = std::sin(angle), u = std::cos(tilt), v = std::sin(tilt);
  return {c, s * u, s * v, -s, c * u, c * v};
}

const Equality kAngle{Equality::Norm::kMax, {}, {0, kTurn}};
const Equality kOrientation{Equality::Norm::kMax, {}, {-1, -1, -1, -1, -1, -1}};

}  // namespace

TEST_CASE("an angle is compared on the shorter way around") {
  const double a[2] = {1, 0.01}, b[2] = {1, kTurn - 0.01}, c[2] = {1, 7 * kTurn + 0.02};
  CHECK(distance(kAngle, 2, a, b) == Approx(0.02));
  CHECK(distance(kAngle, 2, a, c) == Approx(0.01));
  CHECK(are_equal(kAngle, 0.021, 2, a, b));
  CHECK_FALSE(are_equal(kAngle, 0.019, 2, a, b));
  const double d[2] = {1.5, 0.01};  // a plain number beside it
  CHECK(distance(kAngle, 2, a, d) == Approx(0.5));
  const double nan[2] = {1, std::nan("")};
  CHECK_FALSE(are_equal(kAngle, 1e9, 2, a, nan));
}

TEST_CASE("orientations are as far apart as the turn between them") {
  for (const double angle : {0.0, 1e-6, 0.3, 2.0, 3.0})
    CHECK(distance(kOrientation, 6, turned(0.4, 0.7).data(), turned(0.4 + angle, 0.7).data()) ==
          Approx(angle).margin(1e-9));
  // 1e-9: rounding of 1e-16 in the columns, and a slope of at most 15 at 3 rad
  CHECK(distance(kOrientation, 6, turned(0, 0).data(), turned(0, kPi).data()) ==
        Approx(kPi).margin(1e-6));
}

TEST_CASE("a blend turns the shorter way and stays orthonormal") {
  const std::array<double, 8> w{0.75, 0.25, 0, 0, 0, 0, 0, 0};
  const std::vector<double> a{0, 0.1}, b{1, kTurn - 0.3};
  std::array<const double*, 8> rows;
  rows.fill(a.data());
  rows[1] = b.data();
  std::vector<double> row{0.75 * a[0] + 0.25 * b[0], 0.75 * a[1] + 0.25 * b[1]};
  blend_angles(kAngle, w, rows, row);
  CHECK(row[0] == Approx(0.25));
  CHECK(std::abs(row[1]) < 1e-14);  // 0.75 times 0.1 less 0.25 times 0.3, but for rounding

  const std::vector<double> p = turned(0.2, 0.5), q = turned(1.0, 0.5);
  std::vector<double> half(6);
  for (int k = 0; k < 6; ++k) half[k] = (p[k] + q[k]) / 2;
  blend_angles(kOrientation, {0.5, 0.5, 0, 0, 0, 0, 0, 0}, rows, half);
  orthonormalise_rotations(kOrientation, half);
  // Half way between two turns around the same axis: the mean of columns, made longer.
  const std::vector<double> middle = turned(0.6, 0.5);
  for (int k = 0; k < 6; ++k) CHECK(half[k] == Approx(middle[k]).margin(1e-12));

  std::vector<double> nothing(6, 0);
  orthonormalise(nothing.data());
  CHECK(nothing == std::vector<double>{1, 0, 0, 0, 1, 0});
}

TEST_CASE("periods fit a state") {
  const auto fits = [](const std::vector<double>& periods, std::uint32_t n) {
    return Equality{Equality::Norm::kMax, {}, periods}.fits(n);
  };
  CHECK(fits({}, 3));
  CHECK(fits({0, 1, 0}, 3));
  CHECK(fits({-1, -1, -1, -1, -1, -1}, 6));
  CHECK(fits({2, -1, -1, -1, -1, -1, -1, 0}, 8));
  CHECK_FALSE(fits({0, 1}, 3));
  CHECK_FALSE(fits({0, -2, 0}, 3));
  CHECK_FALSE(fits({-1, -1, -1, -1, -1}, 5));
  CHECK_FALSE(fits({-1, -1, -1, -1, -1, 0}, 6));
  CHECK_FALSE(fits({std::nan("")}, 1));
}
