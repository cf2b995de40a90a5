#include "tools/apps/molecule/energy.hpp"

#include <sstream>

#include "tests/unit/catch.hpp"
#include "tests/unit/molecule/reference.hpp"

using namespace molecules;
using Catch::Matchers::StartsWith;

namespace {

const EnergyParameters kParameters{1.3, 150, 30, 120, 4};

std::string first_frame() {
  const std::string whole = text("paths", "sn2.xyz");
  return whole.substr(0, whole.find("\n6\n") + 1);
}

/// Every other frame of a reaction's path, and its first half: both begin in one shape.
Molecule reacting() {
  std::istringstream in(text("paths", "sn2.xyz"));
  std::string texts[2];
  for (int line = 0, size = 8; line < 21 * size; ++line) {
    std::string words;
    std::getline(in, words);
    const int frame = line / size;
    if (frame % 2 == 0) texts[0] += words + "\n";
    if (frame < 11) texts[1] += words + "\n";
  }
  return read_molecule(first_frame(), {texts[0], texts[1]}, {}, true);
}

/// A molecule, what the hand holds of it, and what of it is fixed.
struct Case {
  Source source;
  std::vector<int> hold, fixed;

  Molecule read() const {
    Molecule molecule = source.name == "paths" ? reacting() : source.read();
    molecule.fixed = fixed;
    return molecule;
  }
  EnergyParameters parameters() const {
    EnergyParameters p = kParameters;
    p.hold = hold;
    p.hold_force = 60, p.hold_width = 0.7;
    return p;
  }
};

const std::vector<Case> kCases{{kOnePath, {}, {}},
                               {kButane, {}, {}},
                               {kDipeptide, {}, {}},
                               {kEnkephalin, {}, {}},
                               {kButane, {3}, {}},
                               {kButane, {4}, {2, 3, 11}},
                               {kDipeptide, {9, 10, 19}, {0, 1, 4, 5}},
                               {{"paths", {"sn2", "half"}}, {2}, {}},
                               {{"paths", {"sn2", "half"}}, {}, {0, 3, 4, 5}}};

/// The probe near some atom, so that it touches one or more.
std::array<double, 3> touching(Random& random, HybridEnergy& energy, const std::vector<double>& s) {
  const Positions p = positions(energy, s);
  const Eigen::Vector3d x = p[random.below(p.size())] + random.between(1, 2.4) * random.direction();
  return {x.x(), x.y(), x.z()};
}

}  // namespace

TEST_CASE("the molecule's energy is that of the texts at the nodes, and flat at both ends") {
  for (const Source& source : kAll) {
    const HybridEnergy energy(source.read(), {});
    for (std::size_t k = 0; k < source.paths.size(); ++k) {
      const std::vector<double> given = energies(source.transition_states()[k]);
      REQUIRE(given.size() == 11);
      std::vector<double> t(source.paths.size());
      for (std::size_t m = 0; m < given.size(); ++m) {
        t[k] = static_cast<double>(m) / 10;
        CHECK(energy.shape_energy(t.data()) == Approx(given[m]).margin(1e-12));
      }
      t[k] = 0;
      CHECK(energy.shape_energy(t.data()) == 0);
      t[k] = 1;
      CHECK(energy.shape_energy(t.data()) == given.back());
      const hapgrid::molecule::Profile profile(given);
      CHECK(profile.at(0).slope == 0);
      CHECK(std::abs(profile.at(1).slope) < 1e-12 * given.back());
      // No extremum between nodes.
      for (double at = 0; at <= 1; at += 1.0 / 1024) {
        const std::size_t m = std::min<std::size_t>(static_cast<std::size_t>(at * 10), 9);
        const double e = profile.at(at).energy;
        CHECK(e >= std::min(given[m], given[m + 1]) - 1e-12);
        CHECK(e <= std::max(given[m], given[m + 1]) + 1e-12);
      }
    }
  }
}

TEST_CASE("paths add up: two transition states at once have the sum of their energies") {
  const HybridEnergy energy(kDipeptide.read(), {});
  const double both[4] = {1, 1, 0, 0}, one[4] = {1, 0, 0, 0}, other[4] = {0, 1, 0, 0};
  CHECK(energy.shape_energy(both) == energy.shape_energy(one) + energy.shape_energy(other));
}

TEST_CASE("the hybrid energy is its definition, evaluated from the positions") {
  Random random(4);
  for (const Case& one : kCases) {
    const Molecule molecule = one.read();
    HybridEnergy energy(molecule, one.parameters());
    const std::size_t paths = one.source.paths.size();
    for (int trial = 0; trial < 200; ++trial) {
      const std::vector<double> s = random.state(energy);
      const auto x = touching(random, energy, s);
      const Positions p = positions(energy, s);
      double expected = energy.shape_energy(s.data());
      if (molecule.bonds_change)  // on one path at a time
        expected +=
            1000 * std::pow(energy.morph().length(0) * s[0] * energy.morph().length(1) * s[1], 2);
      Eigen::Vector3d held = -Eigen::Vector3d(x.data());
      for (const int i : one.hold) held += p[i] / static_cast<double>(one.hold.size());
      if (!one.hold.empty()) expected += 60 * (std::sqrt(held.squaredNorm() + 0.49) - 0.7);
      for (std::size_t i = 0; i < p.size() && one.hold.empty(); ++i) {
        const double overlap = molecule.atoms[i]->radius + kParameters.probe_radius -
                               (p[i] - Eigen::Vector3d(x.data())).norm();
        if (overlap > 0) expected += 0.5 * kParameters.penalty * overlap * overlap;
      }
      for (std::size_t i = 0; i < s.size(); ++i)
        expected += 0.5 * s[i] * s[i] *
                    (i < paths       ? kParameters.morph_stiffness
                     : i < paths + 3 ? kParameters.shift_stiffness
                                     : kParameters.rotation_stiffness);
      CHECK(energy.value(s.data(), x.data()) == Approx(expected).epsilon(1e-12));
    }
  }
}

TEST_CASE("what is fixed lies as well as it can on the conformation, and nothing else counts") {
  const Case one{kDipeptide, {}, {0, 1, 4, 5}};
  const Molecule molecule = one.read();
  HybridEnergy energy(molecule, one.parameters());
  Random random(12);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<double> s = random.state(energy);
    std::fill(s.end() - 6, s.end(), 0.0);
    const Positions p = positions(energy, s);
    // The least weighted sum of squares has no force and no torque.
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = force;
    for (const int i : one.fixed) {
      force += molecule.atoms[i]->mass * (p[i] - molecule.conformation[i]);
      torque += molecule.atoms[i]->mass * molecule.conformation[i].cross(p[i]);
    }
    CHECK(force.norm() < 1e-11);
    CHECK((torque - energy.morph().centre().cross(force)).norm() < 1e-9);
  }
}

TEST_CASE("shift and rotation move the shape about the centre of mass") {
  const Molecule molecule = kDipeptide.read();
  HybridEnergy energy(molecule, {});
  const Eigen::Vector3d centre = energy.morph().centre();
  Random random(5);
  for (const double size : {1e-9, 1e-3, 0.099, 0.101, 1.0, 3.0}) {
    std::vector<double> s(energy.variables());
    s[0] = 0.4;
    const Positions before = positions(energy, s);
    const Eigen::Vector3d axis = random.direction();
    for (int a = 0; a < 3; ++a) s[4 + a] = a + 0.5, s[7 + a] = size * axis[a];
    const Positions after = positions(energy, s);
    const Eigen::Matrix3d r = Eigen::AngleAxisd(size, axis).toRotationMatrix();
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Eigen::Vector3d expected =
          r * (before[i] - centre) + centre + Eigen::Vector3d(0.5, 1.5, 2.5);
      CHECK((after[i] - expected).norm() < 1e-14 * 50);
    }
  }
}

TEST_CASE("the gradient is that of central differences, and the Hessian the gradient's") {
  Random random(6);
  constexpr double kStep = 1e-5;
  for (const Case& one : kCases) {
    HybridEnergy energy(one.read(), one.parameters());
    const std::size_t n = energy.variables(), paths = one.source.paths.size();
    std::vector<double> g(n), h(n * n), above(n), below(n), unused(n * n);
    double worst = 0, worst_second = 0;
    for (int trial = 0; trial < 200; ++trial) {
      std::vector<double> s = random.state(energy);
      // The Hessian leaves out the second derivatives of the rotation's parametrisation: they are 0
      // without a rotation.
      const bool turned = trial % 2;
      for (std::size_t i = 0; i < 3; ++i)
        if (!turned) s[paths + 3 + i] = 0;
      // Away from the nodes, where the curvature jumps.
      for (std::size_t k = 0; k < paths; ++k)
        s[k] = (std::floor(s[k] * 9.99) + random.between(0.1, 0.9)) / 10;
      const auto x = touching(random, energy, s);
      energy.value(s.data(), x.data());
      const bool touched = energy.touches();
      energy.derivatives(g.data(), h.data(), true);
      for (std::size_t i = 0; i < n; ++i) {
        const auto at = [&](double step) {
          std::vector<double> moved = s;
          moved[i] += step;
          return energy.value(moved.data(), x.data());
        };
        const double up = at(kStep);
        energy.derivatives(above.data(), unused.data(), true);
        const double down = at(-kStep);
        energy.derivatives(below.data(), unused.data(), true);
        // Half the step leaves a quarter of the error: three times what is left is the change.
        const double coarse = (up - down) / (2 * kStep);
        const double fine = (at(kStep / 2) - at(-kStep / 2)) / kStep;
        // Energies of up to 1e4 kJ/mol are rounded to 2e-12, some ten times on the way.
        worst = std::max(worst, std::abs(fine - g[i]) - std::abs(fine - coarse));
        for (std::size_t j = 0; j < n && !turned && touched; ++j) {
          const double second = (above[j] - below[j]) / (2 * kStep);
          // Where an atom begins to touch within the step the gradient has a corner.
          const double scale = 1 + std::abs(h[i * n + j]);
          worst_second = std::max(worst_second, std::abs(second - h[i * n + j]) / scale);
        }
      }
    }
    INFO(one.source.name << " off by " << worst << " and " << worst_second);
    CHECK(worst < 2e-11 / kStep);
    CHECK(worst_second < 1e-3);
  }
}

TEST_CASE("where bonds break and form the shapes and energies are those of the frames") {
  const Molecule molecule = reacting();
  HybridEnergy energy(molecule, {});
  CHECK(molecule.bonds.size() == 5);  // of all frames
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t m = 0; m < 11; ++m) {
      std::vector<double> s(energy.variables());
      s[k] = static_cast<double>(m) / 10;
      CHECK(superposed_rmsd(positions(energy, s), molecule.paths[k].nodes[m]) < 1e-7);
      CHECK(energy.shape_energy(s.data()) == Approx(molecule.paths[k].energies[m]).margin(1e-12));
    }
  CHECK_THROWS_WITH(read_molecule(first_frame(), {}, {}),
                    StartsWith("conformation: not one molecule"));
}
