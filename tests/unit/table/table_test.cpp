// What is outside of a table, and where it is lowest and steepest. Inside it and at its wall,
// tests/cli/table/formats.sh compares it with splines of SciPy.

#include "tests/unit/catch.hpp"
#include "tools/apps/table/field.hpp"

using namespace hapgrid::table;

namespace {

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

TEST_CASE("outside, the gradient is that of the energy") {
  Lattice l = lattice({6, 6, 6}, kStraight, {0, 0, 0});
  fill(l, [](const Vector& x) { return x[0] * x[0] * x[1] + x[1] * x[1] + x[1] * x[2] * x[2]; });
  const Field field(l, {}, "table");
  double edge[3], unused[3];
  const Vector corner{5, 5, 5};
  CHECK(field.at(corner.data(), edge) == Approx(275));  // the edge is inside
  CHECK(edge[0] == Approx(50));
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
