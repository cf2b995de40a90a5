#include "tests/unit/catch.hpp"
#include "tests/unit/hung_ball/reference.hpp"

using namespace hapgrid;
using namespace hung_ball;

namespace {

const double kTearOff = 2 * std::sqrt(kRadius * (kRadius + 1));  // t

/// The state at (x, 0, 0) when the HIP comes from `from`, in shifts well below d_max.
double walked_to(Model& model, double from, double x) {
  double alpha = 0;
  const double d = std::copysign(0.02, x - from);
  while (std::abs(x - from) > std::abs(d)) {
    alpha = convert(model, alpha, {from, 0, 0}, {d, 0, 0});
    from += d;
  }
  return convert(model, alpha, {from, 0, 0}, {x - from, 0, 0});
}
double from_left(Model& model, double x) { return walked_to(model, -1, x); }
double from_right(Model& model, double x) { return walked_to(model, 1, x); }

/// Compares C with its definition in words; answers whether the ball touches the HIP in the end.
bool agrees(Model& model, double r, double alpha, const Vec3& x, const Vec3& d) {
  const Vec3 p = x + d;
  const double reached = convert(model, alpha, x, d);
  const Real expected = reference(alpha, x, d, r);
  INFO("r " << r << " α " << alpha << " x " << x[0] << ' ' << x[1] << ' ' << x[2] << " d " << d[0]
            << ' ' << d[1] << ' ' << d[2]);
  if (expected == 0)
    CHECK(reached == 0);
  else
    CHECK(std::abs(reached - expected) <= angle_bound(*arc(p, r), p));
  return expected != 0;
}

double line_bound(double x) {
  const Vec3 p{x, 0, 0};
  return angle_bound(*arc(p, kRadius), p);
}

}  // namespace

TEST_CASE("contact begins at -2r and ends at t, to the last digits") {
  // First x at which the ball is not at rest, on the way from a free to a touched position.
  const auto model = make();
  const auto boundary = [&](double rest, double moved, double start, double alpha) {
    for (;;) {
      const double middle = (rest + moved) / 2;
      if (middle == rest || middle == moved) return middle;
      (convert(*model, alpha, {start, 0, 0}, {middle - start, 0, 0}) == 0 ? rest : moved) = middle;
    }
  };
  // reference.hpp: 80u in s². Contact: sin α = 0 with s = 4r = 0.4, 100u in s, and a slope of 2.
  CHECK(std::abs(boundary(-0.21, -0.19, -0.25, 0) + 0.2) <= 50 * kU);
  // Tear-off: s² itself is 0, with the slope -2 (e - m) 2x = -8rt.
  const double bound = 80 * kU / (8 * kRadius * kTearOff) + 4 * kU;
  const double start = 0.6;
  const double alpha = from_left(*model, start);
  REQUIRE(alpha > 0);
  CHECK(std::abs(boundary(0.7, 0.65, start, alpha) - kTearOff) <= bound);
  const double mirrored = from_right(*model, -start);
  CHECK(std::abs(boundary(-0.7, -0.65, -start, mirrored) + kTearOff) <= bound);
}

TEST_CASE("Table 1, row by row") {
  const auto model = make();
  const double t = kTearOff, r = kRadius, d_max = model->info().d_max;
  const auto C = [&](double alpha, double x, double d) {
    return convert(*model, alpha, {x, 0, 0}, {d, 0, 0});
  };
  /// 0: at rest; 1: α1(x), pushed from the left; 2: α2(x), pushed from the right.
  const auto is = [&](int state, double alpha, double x) {
    if (state == 0) return alpha == 0;
    const Real wanted = state == 1 ? alpha_1(x, r) : alpha_2(x, r);
    return (alpha > 0) == (state == 1) && std::abs(alpha - wanted) <= line_bound(x);
  };
  // From a state in an interval of x into an interval of x + d. "Any" d holds up to -2r, which
  // d_max does not let it pass.
  const struct {
    double low, high;
    int from;
    double there_low, there_high;
    int to;
  } printed[] = {
      {-9, -t, 0, -9, 9, 0},         {-t, -2 * r, 0, -9, -2 * r, 0}, {-t, -2 * r, 0, -2 * r, 9, 1},
      {-2 * r, t, 1, -9, -2 * r, 0}, {-2 * r, t, 1, -2 * r, t, 1},   {-2 * r, t, 1, t, 9, 0},
      {2 * r, t, 0, 2 * r, 9, 0},    {2 * r, t, 0, -9, 2 * r, 2},    {-t, 2 * r, 2, -9, -t, 0},
      {-t, 2 * r, 2, -t, 2 * r, 2},  {-t, 2 * r, 2, 2 * r, 9, 0},    {t, 9, 0, -9, 9, 0}};
  // All shifts up to d_max = t - 2r, which is what makes the rows complete.
  Random random(1);
  int counts[std::size(printed)] = {};
  for (int i = 0; i < 20000; ++i) {
    const double x = random.between(-0.95, 0.95), d = random.between(-d_max, d_max);
    for (std::size_t k = 0; k < std::size(printed); ++k) {
      const auto& row = printed[k];
      if (x < row.low || x > row.high || x + d < row.there_low || x + d > row.there_high) continue;
      const double alpha = row.from == 0   ? 0
                           : row.from == 1 ? from_left(*model, x)
                                           : from_right(*model, x);
      INFO("row " << k << " x " << x << " d " << d);
      REQUIRE(is(row.from, alpha, x));
      CHECK(is(row.to, C(alpha, x, d), x + d));
      ++counts[k];
    }
  }
  for (const int count : counts) CHECK(count > 100);

  // The closed ends of the intervals.
  CHECK(is(1, C(0, -2 * r, 0.1), -2 * r + 0.1));
  CHECK(C(0, 2 * r, 0.1) == 0);
  CHECK(C(from_left(*model, 0), 0, -2 * r) == 0);
  CHECK(C(from_right(*model, 0), 0, 2 * r) == 0);
}

TEST_CASE("random walks agree with the definition in words") {
  for (const double r : {0.1, 0.02, 0.3, 0.45}) {
    const auto model = make({{"radius", r}});
    int contacts = 0;
    int drops = 0;
    const double longest = std::min(3 * r, model->info().d_max);
    walk(*model, r, 2, 20000, longest, [&](double alpha, const Vec3& x, const Vec3& d) {
      const bool touches = agrees(*model, r, alpha, x, d);
      contacts += touches;
      drops += !touches && alpha != 0;
    });
    CHECK(contacts > 2000);
    CHECK(drops > 200);
  }
}

TEST_CASE("from any angle C does what the definition says") {
  // States that no walk reaches, such as a hand writes into [seeds]: α and φ can be far apart.
  const auto model = make();
  Random random(10);
  int contacts = 0;
  for (int i = 0; i < 20000; ++i) {
    const double alpha = random.between(-3.1, 3.1);
    const double phi = random.between(-3.1, 3.1);
    const double rho = 1 + random.between(-0.2, 0.2);
    const Vec3 x{rho * std::sin(phi), random.between(-0.2, 0.2), 1 - rho * std::cos(phi)};
    contacts += agrees(*model, kRadius, alpha, x, random.shift(0.05));
  }
  CHECK(contacts > 2000);
}

TEST_CASE("a tie is decided for the right side") {
  const auto model = make();
  // Straight from below: α = φ = 0.
  CHECK(convert(*model, 0, {0, 0, -0.25}, {0, 0, 0.1}) > 0);
  // Straight from above, past the hinge: likewise.
  CHECK(convert(*model, 0, {0, 0, 0.25}, {0, 0, -0.1}) > 0);
}

TEST_CASE("above the hinge the branch of φ is not felt") {
  const auto model = make();
  // Far above, near the top of the circle: the ball hangs at 0, the HIP crosses φ = ±π.
  for (const double x : {0.15, -0.15, 0.0})
    for (const double d : {0.3, -0.3, 0.0}) CHECK(convert(*model, 0, {x, 0, 2}, {d, 0, 0.01}) == 0);
  // The HIP pushes the ball up the right side; it drops to 0 when the contact angle reaches π,
  // which is when the HIP is an arc δ short of the top, and not later.
  double alpha = 0;
  double phi = -0.3;
  double highest = 0;
  const auto on_circle = [](double angle) { return Vec3{std::sin(angle), 0, 1 - std::cos(angle)}; };
  while (phi < 3.1) {
    const Vec3 x = on_circle(phi);
    const Vec3 end = on_circle(phi += 0.01);
    alpha = convert(*model, alpha, x, end - x);
    highest = std::max(highest, alpha);
    if (alpha == 0 && phi > 0) break;
  }
  const double delta = static_cast<double>(arc(on_circle(phi), kRadius)->delta);
  CHECK(highest > kPi - 0.01);
  CHECK(phi + delta >= kPi);
  CHECK(phi + delta < kPi + 0.01);
}

TEST_CASE("C is defined from no shift at all up to d_max in all directions, and no further") {
  const auto model = make();
  CHECK(convert(*model, 0.25, {0, 0, 0}, {0, 0, 0}) == 0.25);
  const double d_max = model->info().d_max;
  const double diagonal = d_max / std::sqrt(3);
  CHECK(convert(*model, 0, {0.9, 0, 0}, {-d_max, 0, 0}) == 0);
  CHECK(convert(*model, 0, {0.9, 0, 0}, {diagonal, diagonal, diagonal}) == 0);
  CHECK(std::isnan(convert(*model, 0, {0.9, 0, 0}, {-1.001 * d_max, 0, 0})));
}

TEST_CASE("rest is known where the ball at rest does not overlap the HIP") {
  const auto model = make();
  Random random(6);
  int overlaps = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = random.shift(0.5);
    const auto a = arc(p, kRadius);
    const bool overlap = a && std::abs(a->phi) < a->delta;
    overlaps += overlap;
    CHECK(model->known_states(p) == (overlap ? std::vector<double>{} : std::vector<double>{0}));
  }
  CHECK(overlaps > 500);
}
