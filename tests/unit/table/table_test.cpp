// Splines and fields against polynomials, which a not-a-knot spline reproduces. A sheared lattice
// is in tests/cli/table/formats.sh.

#include "tests/unit/catch.hpp"
#include "tools/apps/table/field.hpp"

using namespace hapgrid::table;
using Catch::Matchers::ContainsSubstring;

namespace {

// A product of cubics, and its derivatives: what a tricubic spline has in its space.
double f(double t) { return 1 + t * (0.5 + t * (-0.3 + t * 0.07)); }
double df(double t) { return 0.5 + t * (-0.6 + t * 0.21); }
double ddf(double t) { return -0.6 + t * 0.42; }
double g(double t) { return 2 - t * (0.4 - t * 0.02); }
double dg(double t) { return -0.4 + t * 0.04; }
double h(double t) { return t * t * t * 0.01 - t; }
double dh(double t) { return t * t * 0.03 - 1; }

Lattice lattice(const Spline::Counts& counts, const std::array<Vector, 3>& axes,
                const Vector& origin) {
  std::string text = "hapgrid-table\ncounts";
  for (const std::size_t n : counts) text += " " + std::to_string(n);
  const auto row = [&](const char* word, const Vector& v) {
    text += std::string("\n") + word;
    for (const double c : v) text += " " + std::to_string(c);
  };
  row("origin", origin);
  for (const Vector& axis : axes) row("axis", axis);
  text += "\natom O 0 0 0\nvalues\n";
  for (std::size_t n = 0; n < counts[0] * counts[1] * counts[2]; ++n) text += "0 ";
  return read_lattice(text, "table");
}

/// Puts e(x) at each point.
template <class Energy>
void fill(Lattice& l, const Energy& e) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < l.counts[2]; ++k)
    for (std::size_t j = 0; j < l.counts[1]; ++j)
      for (std::size_t i = 0; i < l.counts[0]; ++i) {
        Vector x = l.origin;
        for (int c = 0; c < 3; ++c)
          x[c] += static_cast<double>(i) * l.axes[0][c] + static_cast<double>(j) * l.axes[1][c] +
                  static_cast<double>(k) * l.axes[2][c];
        l.values[n++] = e(x);
      }
}

const std::array<Vector, 3> kStraight{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

}  // namespace

TEST_CASE("a spline reproduces products of cubics with their derivatives, up to the edge") {
  for (const Spline::Counts& counts :
       {Spline::Counts{4, 5, 6}, Spline::Counts{9, 4, 7}, Spline::Counts{5, 12, 4}}) {
    std::vector<double> values;
    for (std::size_t k = 0; k < counts[2]; ++k)
      for (std::size_t j = 0; j < counts[1]; ++j)
        for (std::size_t i = 0; i < counts[0]; ++i)
          values.push_back(f(static_cast<double>(i)) * g(static_cast<double>(j)) *
                           h(static_cast<double>(k)));
    const Spline spline(counts, values);
    for (const double part : {0.0, 0.13, 0.5, 0.77, 1.0}) {
      const double x = part * static_cast<double>(counts[0] - 1);
      const double y = (1 - part) * static_cast<double>(counts[1] - 1);
      const double z = part * part * static_cast<double>(counts[2] - 1);
      const Spline::Value v = spline.at({x, y, z}, true);
      // Rounding: about 1e3 operations on numbers below 1e3.
      const auto near = [](double expected) { return Approx(expected).margin(1e-9); };
      CHECK(v.value == near(f(x) * g(y) * h(z)));
      CHECK(v.gradient[0] == near(df(x) * g(y) * h(z)));
      CHECK(v.gradient[1] == near(f(x) * dg(y) * h(z)));
      CHECK(v.gradient[2] == near(f(x) * g(y) * dh(z)));
      CHECK(v.hessian[0] == near(ddf(x) * g(y) * h(z)));
      CHECK(v.hessian[3] == near(df(x) * dg(y) * h(z)));
      CHECK(v.hessian[4] == near(df(x) * g(y) * dh(z)));
      CHECK(v.hessian[5] == near(f(x) * dg(y) * dh(z)));
    }
  }
}

TEST_CASE("outside, the gradient is that of the energy") {
  Lattice l = lattice({6, 6, 6}, kStraight, {0, 0, 0});
  fill(l, [](const Vector& x) { return x[0] * x[1] + x[2]; });
  const Field field(l, {}, "table");
  double edge[3], unused[3];
  const Vector corner{5, 5, 5};
  CHECK(field.at(corner.data(), edge) == Approx(30));  // the edge is inside
  CHECK(edge[0] == Approx(5));
  for (const Vector& x : {Vector{-0.4, 2, 3}, Vector{6, 5.5, 1}, Vector{2, -3, 9}}) {
    double gradient[3];
    field.at(x.data(), gradient);
    for (int c = 0; c < 3; ++c) {
      const double step =
          1e-5;  // the error of central differences: step² times the third derivative
      Vector a = x, b = x;
      a[c] -= step, b[c] += step;
      const double slope = (field.at(b.data(), unused) - field.at(a.data(), unused)) / (2 * step);
      CHECK(gradient[c] == Approx(slope).margin(1e-6));
    }
  }
}

TEST_CASE("a wall presses high and missing values below its height and leaves low ones") {
  Lattice l = lattice({8, 8, 8}, kStraight, {0, 0, 0});
  fill(l, [](const Vector& x) {
    return x[0] < 4 ? x[0] + 0.1 * x[1] : x[0] < 6 ? 1e5 : std::nan("");
  });
  CHECK_THROWS_WITH(Field(l, {}, "table"), ContainsSubstring("values are missing"));
  CHECK_THROWS_WITH(Field(l, {.wall = -1, .has_wall = true}, "table"),
                    ContainsSubstring("no value is below"));
  const Field field(l, {.wall = 20, .has_wall = true}, "table");
  double unused[3];
  for (const double y : {0.0, 3.0, 7.0}) {
    const Vector low{2, y, 3}, high{4, y, 3}, missing{7, y, 3};
    CHECK(field.at(low.data(), unused) == Approx(2 + 0.1 * y));  // below half of the height
    CHECK(field.at(high.data(), unused) == Approx(20));
    CHECK(field.at(missing.data(), unused) == Approx(20));
  }
  // The spline may swing beside the wall, by no more than a cubic spline does at a step, 11 %.
  double most = 0;
  for (double x = 0; x <= 7; x += 0.01) {
    const Vector at{x, 3, 3};
    most = std::max(most, field.at(at.data(), unused));
  }
  CHECK(most < 22.3);
}

TEST_CASE("a field knows where it is lowest and steepest") {
  Lattice l = lattice({9, 9, 9}, kStraight, {-4, -4, -4});
  fill(l, [](const Vector& x) {
    return x[0] * x[0] + (x[1] - 1) * (x[1] - 1) + (x[2] + 2) * (x[2] + 2);
  });
  const Field field(l, {}, "table");
  REQUIRE(field.minima().size() == 1);
  CHECK(field.minima()[0] == Vector{0, 1, -2});
  CHECK(field.steepest() == Approx(2 * std::sqrt(16.0 + 25 + 36)));
}

TEST_CASE("the steepest place may lie between the points") {
  Lattice l = lattice({10, 4, 4}, kStraight, {0, 0, 0});
  fill(l, [](const Vector& x) { return x[0] < 4.5 ? 0 : 1; });
  const Field field(l, {}, "table");
  double most = 0;
  for (double x = 0; x <= 9; x += 0.01) {
    const Vector at{x, 1, 1};
    Vector slope;
    field.at(at.data(), slope.data());
    most = std::max(most, std::abs(slope[0]));
  }
  CHECK(most > 1.1);  // beside the step, at the points, it is (3 - sqrt(3)) / 2
  CHECK(field.steepest() == Approx(most));
}
