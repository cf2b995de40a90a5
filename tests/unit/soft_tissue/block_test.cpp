// The finite elements of the soft tissue: patch tests against the linear theory, derivatives
// against differences, symmetry, contact against its definition. Small meshes; mm, N, N/mm^2.
#include "examples/soft-tissue/block.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "tests/unit/catch.hpp"

using namespace soft_tissue;

namespace {

constexpr double kFar = 1e6;
const Vec3 kNowhere(0, 0, kFar);

Options small_options(double adhesion = Options{}.adhesion) {
  Options o;
  o.size = {24, 24, 12};
  o.elements = {4, 4, 2};
  o.probe_radius = 8;
  o.adhesion = adhesion;
  return o;
}

Vector zero(const Block& block) {
  return Vector::Zero(static_cast<Eigen::Index>(block.unknowns()));
}

/// A node's part of a vector.
auto at(Vector& u, std::size_t node) { return u.segment<3>(static_cast<Eigen::Index>(3 * node)); }

/// The displacement u(x) = z column, which is 0 on the ground.
Vector sheared(const Block& block, const Vec3& column) {
  Vector u = zero(block);
  for (std::size_t i = 0; i < block.nodes(); ++i) at(u, i) = block.rest(i)[2] * column;
  return u;
}

/// Lamé's constants of the material.
struct Lame {
  explicit Lame(const Options& o)
      : lambda(o.young_modulus * o.poisson_ratio /
               ((1 + o.poisson_ratio) * (1 - 2 * o.poisson_ratio))),
        mu(o.young_modulus / (2 * (1 + o.poisson_ratio))) {}
  double lambda, mu;
};

Vector random_displacement(const Block& block, double size, unsigned seed) {
  std::mt19937_64 bits(seed);
  Vector u = zero(block);
  for (double& x : u) x = size * (2 * (static_cast<double>(bits() >> 11) * 0x1p-53) - 1);
  return u;
}

Eigen::MatrixXd full(const Matrix& lower) {
  const Eigen::MatrixXd m(lower);
  return m + m.transpose() - Eigen::MatrixXd(m.diagonal().asDiagonal());
}

}  // namespace

TEST_CASE("a homogeneous strain has the energy of the closed form") {
  // F = I + column e_z^T. St. Venant-Kirchhoff's energy is exact at any strain; at the smallest
  // here it is that of the linear theory, (lambda + 2 mu)/2 e^2 and mu/2 e^2, up to a relative
  // 1e-4.
  const Options o = small_options();
  const Block block(o);
  const auto [lambda, mu] = Lame(o);
  const double volume = o.size[0] * o.size[1] * o.size[2];
  Vector g;
  for (const double e : {1e-4, -1e-4, 0.2, -0.2}) {
    // Uniaxial strain: E_zz = e + e^2/2.
    const double strain = e + e * e / 2;
    CHECK(block.energy(sheared(block, {0, 0, e}), kNowhere, g) ==
          Approx(volume * (lambda / 2 + mu) * strain * strain).epsilon(1e-12));
    // Simple shear: E_xz = e/2, E_zz = e^2/2.
    const double square = e * e / 2;
    CHECK(block.energy(sheared(block, {e, 0, 0}), kNowhere, g) ==
          Approx(volume * (lambda / 2 * square * square + mu * (e * e / 2 + square * square)))
              .epsilon(1e-12));
  }
}

TEST_CASE("the patch test: homogeneous stress leaves no force inside and its traction on top") {
  const Options o = small_options();
  const Block block(o);
  const auto [lambda, mu] = Lame(o);
  const double e = 1e-5;
  for (const bool shear : {false, true}) {
    Vector g;
    block.energy(sheared(block, shear ? Vec3(e, 0, 0) : Vec3(0, 0, e)), kNowhere, g);
    Vec3 top = Vec3::Zero();
    for (std::size_t i = 0; i < block.nodes(); ++i) {
      const Vec3 f = at(g, i);
      const Vec3& x = block.rest(i);
      if (x[2] == o.size[2]) top += f;
      if (std::abs(x[0]) < 12 && std::abs(x[1]) < 12 && x[2] < 12) CHECK(f.norm() < 1e-16);
    }
    const double area = o.size[0] * o.size[1];
    const Vec3 traction = shear ? Vec3(mu * e, 0, 0) : Vec3(0, 0, (lambda + 2 * mu) * e);
    // Up to the quadratic terms of the strain, times the stiffest modulus over the shear modulus.
    CHECK((top - area * traction).norm() <= 5 * e * area * (lambda + 2 * mu) * e);
  }
}

TEST_CASE("a rigid motion of all that an element sees has no energy") {
  // The ground is fixed, so only elements above its layer can move rigidly: the energy of a moved
  // and turned upper part is all in the lowest layer. Compared with the same lowest layer alone.
  Options o = small_options();
  o.elements = {4, 4, 1};
  o.size[2] = 6;
  const Block low(o);
  const Block high(small_options());
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const auto moved = [&](const Block& block) {
    Vector u = zero(block);
    for (std::size_t i = 0; i < block.nodes(); ++i) {
      const Vec3& x = block.rest(i);
      at(u, i) = turn * (x - Vec3(0, 0, 6)) + Vec3(0.1, 0.2, 6.3) - x;
    }
    return u;
  };
  Vector g;
  const double lowest = low.energy(moved(low), kNowhere, g);
  REQUIRE(lowest > 0.1);
  CHECK(high.energy(moved(high), kNowhere, g) == Approx(lowest).epsilon(1e-12));
  CHECK(high.energy(zero(high), kNowhere, g) == 0);
  CHECK(g.norm() == 0);
}

TEST_CASE("gradient and tangent are the derivatives of the energy, in and out of contact") {
  for (const double adhesion : {0.0, 4e-3}) {
    const Block block(small_options(adhesion));
    const Vector u = random_displacement(block, 0.3, 1);
    const Vec3 centre(3, -2, 12 + 8 - 1.5);
    Vector g, g_high, g_low;
    Matrix k;
    block.energy(u, centre, g);
    block.tangent(u, centre, k);
    const Eigen::MatrixXd stiffness = full(k);
    // Central differences: step^2/6 of the third derivative, which jumps where the pressure's
    // second derivative does, plus the rounding of 1e-16 times the sums over the step.
    constexpr double kStep = 1e-5;
    double worst_g = 0, worst_k = 0;
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      Vector high = u, low = u;
      high[i] += kStep;
      low[i] -= kStep;
      const double slope =
          (block.energy(high, centre, g_high) - block.energy(low, centre, g_low)) / (2 * kStep);
      worst_g = std::max(worst_g, std::abs(slope - g[i]));
      const Vector column = (g_high - g_low) / (2 * kStep);
      worst_k = std::max(worst_k, (column - stiffness.col(i)).lpNorm<Eigen::Infinity>());
    }
    CHECK(g.lpNorm<Eigen::Infinity>() > 0.01);
    CHECK(worst_g < 1e-9);
    CHECK(worst_k < 1e-6);
    REQUIRE(block.force(u, centre).norm() > 0.01);
    Vec3 along;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 d = kStep * Vec3::Unit(axis);
      along[axis] =
          (block.energy(u, centre + d, g_high) - block.energy(u, centre - d, g_low)) / (2 * kStep);
    }
    CHECK((block.force(u, centre) + along).norm() < 1e-8);
  }
}

TEST_CASE("an equilibrium is one, and its force is minus the slope of its energy") {
  for (const double adhesion : {0.0, 2e-3}) {
    const Options o = small_options(adhesion);
    Block block(o);
    const auto at = [&](const Vec3& centre, Vector& u, double& energy) {
      Vector g;
      block.relax(u, centre);
      energy = block.energy(u, centre, g);
      CHECK(g.lpNorm<Eigen::Infinity>() <= o.residual);
      Matrix k;
      block.tangent(u, centre, k);
      CHECK(Eigen::LLT<Eigen::MatrixXd>(full(k)).info() == Eigen::Success);  // stable
    };
    Vector u = zero(block);
    Vec3 centre(1, 0.5, 20 + 2);
    block.follow(u, centre + Vec3(0, 0, 4), centre, 0.5);
    for (const double depth : {1.0, 2.0}) {
      const Vec3 next(1, 0.5, 20 - depth);
      block.follow(u, centre, next, 0.5);
      centre = next;
      const Vec3 force = block.force(u, centre);
      INFO("depth " << depth << " force " << force.transpose());
      CHECK(force.norm() > 0.005);
      constexpr double kStep = 1e-4;
      for (int axis = 0; axis < 3; ++axis) {
        Vector high = u, low = u;
        double e_high, e_low;
        at(centre + kStep * Vec3::Unit(axis), high, e_high);
        at(centre - kStep * Vec3::Unit(axis), low, e_low);
        // step^2/6 of the third derivative; residuals enter squared.
        CHECK(std::abs((e_high - e_low) / (2 * kStep) + force[axis]) < 1e-6);
      }
    }
  }
}

TEST_CASE("a centred poke leaves the block's symmetries") {
  Block block(small_options(0));
  Vector u = zero(block);
  block.follow(u, Vec3(0, 0, 22), Vec3(0, 0, 18.5), 0.5);
  const Vec3 force = block.force(u, Vec3(0, 0, 18.5));
  CHECK(force[2] > 0.02);
  // The residual, over the softest mode's stiffness.
  constexpr double kBound = 1e-5;
  CHECK(std::hypot(force[0], force[1]) < kBound);
  const auto find = [&](const Vec3& x) {
    for (std::size_t i = 0; i < block.nodes(); ++i)
      if (block.rest(i) == x) return Vec3(at(u, i));
    FAIL("no node there");
    return Vec3();
  };
  for (std::size_t i = 0; i < block.nodes(); ++i) {
    const Vec3& x = block.rest(i);
    const Vec3 mirrored = find({-x[0], x[1], x[2]}), swapped = find({x[1], x[0], x[2]});
    CHECK((at(u, i) - Vec3(-mirrored[0], mirrored[1], mirrored[2])).norm() < kBound);
    CHECK((at(u, i) - Vec3(swapped[1], swapped[0], swapped[2])).norm() < kBound);
  }
  CHECK(find({0, 0, 12})[2] < -0.5);
}

TEST_CASE("the ball is clear of the block where no point of the surface is in reach") {
  const Block sticky(small_options()), dry(small_options(0));
  CHECK(sticky.is_clear({0, 0, 20 + 2.1}));
  CHECK_FALSE(sticky.is_clear({1, 1, 20 + 1.5}));
  CHECK(dry.is_clear({1, 1, 20.1}));
  CHECK_FALSE(dry.is_clear({1, 1, 19.5}));
}
