#include "tools/apps/molecule/morph.hpp"

#include "tests/unit/catch.hpp"
#include "tests/unit/molecule/reference.hpp"
#include "tools/apps/molecule/elementary.hpp"

using namespace molecules;

namespace {

Positions of(const Morph& morph, const Morph::Shape& shape) {
  Positions p(morph.atoms());
  for (std::size_t i = 0; i < morph.atoms(); ++i)
    p[morph.tree().order[i]] = {shape.x[i], shape.y[i], shape.z[i]};
  return p;
}

Positions shape_at(const Morph& morph, const std::vector<double>& t) {
  Morph::Shape shape = morph.make_shape();
  morph.shape(t.data(), shape);
  return of(morph, shape);
}

}  // namespace

TEST_CASE("sines, cosines and angles are those of the C library") {
  Random random(1);
  for (int i = 0; i < 100000; ++i) {
    const double range = i % 2 ? 10 : 1e4;
    const double angles[2] = {random.between(-range, range), random.between(-range, range)};
    double sines[2], cosines[2];
    hapgrid::molecule::sines_and_cosines(angles, sines, cosines, 2);
    for (int j = 0; j < 2; ++j) {
      // 2 ulp of 1, and what the reduction leaves of a large angle: none of it is rounded off.
      CHECK(std::abs(sines[j] - std::sin(static_cast<long double>(angles[j]))) < 4.5e-16L);
      CHECK(std::abs(cosines[j] - std::cos(static_cast<long double>(angles[j]))) < 4.5e-16L);
    }
    const double x = random.between(-1, 1), y = random.between(-1, 1);
    const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    CHECK(std::abs(hapgrid::molecule::angle_of(y, x) - exact) < 9e-16L);  // 2 ulp of π
  }
  CHECK(hapgrid::molecule::angle_of(0, -1) == Approx(M_PI).epsilon(1e-15));
  CHECK(hapgrid::molecule::angle_of(1, 0) == Approx(M_PI / 2).epsilon(1e-15));
  CHECK(hapgrid::molecule::angle_of(0, 0) == 0);
}

TEST_CASE("along each path the nodes of its text are reproduced") {
  for (const Source& source : kAll) {
    const Morph morph(source.read());
    for (std::size_t k = 0; k < source.paths.size(); ++k) {
      const std::vector<Positions> nodes = frames(source.transition_states()[k]);
      REQUIRE(nodes.size() == 11);
      for (std::size_t m = 0; m < nodes.size(); ++m) {
        std::vector<double> t(source.paths.size());
        t[k] = static_cast<double>(m) / 10;
        const Positions shape = shape_at(morph, t);
        INFO(source.name << " path " << k << " node " << m);
        // The first one is the conformation of another text, rounded to 1e-8 Å both times.
        CHECK(superposed_rmsd(shape, nodes[m]) < (m == 0 ? 1e-5 : 1e-10));
        for (std::size_t a = 0; a + 3 < shape.size(); ++a) {
          // Any four atoms have a torsion, bonded or not; those near a line tell nothing.
          const int i = static_cast<int>(a);
          const Eigen::Vector3d u = nodes[m][i + 1] - nodes[m][i],
                                v = nodes[m][i + 2] - nodes[m][i + 1],
                                w = nodes[m][i + 3] - nodes[m][i + 2];
          if (u.cross(v).norm() < 0.1 || v.cross(w).norm() < 0.1 || m == 0) continue;
          const double difference =
              torsion(shape, i, i + 1, i + 2, i + 3) - torsion(nodes[m], i, i + 1, i + 2, i + 3);
          CHECK(std::abs(std::remainder(difference, 2 * M_PI)) < 1e-8);
        }
      }
    }
  }
}

TEST_CASE("at t = 0 the shape is the conformation, where its text has it") {
  for (const Source& source : kAll) {
    const Molecule molecule = source.read();
    HybridEnergy energy(molecule, {});
    CHECK(rmsd(positions(energy, std::vector<double>(energy.variables())), molecule.conformation) <
          1e-13);
  }
}

TEST_CASE("bond lengths between nodes stay those of the nodes") {
  for (const Source& source : kAll) {
    const Molecule molecule = source.read();
    const Morph morph(molecule);
    const hapgrid::molecule::Tree& tree = morph.tree();
    for (std::size_t k = 0; k < source.paths.size(); ++k) {
      for (double at = 0; at <= 1; at += 0.03125) {
        std::vector<double> t(source.paths.size());
        t[k] = at;
        const Positions shape = shape_at(morph, t);
        for (std::size_t i = 1; i < tree.size(); ++i) {
          const int a = tree.order[i], b = tree.order[tree.parent[i]];
          double least = 1e9, most = 0;
          for (const Positions& node : molecule.paths[k].nodes) {
            least = std::min(least, (node[a] - node[b]).norm());
            most = std::max(most, (node[a] - node[b]).norm());
          }
          const double length = (shape[a] - shape[b]).norm();
          // A spline swings past its nodes by a part of their range.
          const double margin = 0.25 * (most - least) + 1e-9;
          CHECK(length > least - margin);
          CHECK(length < most + margin);
        }
      }
    }
  }
}

TEST_CASE("the alignment leaves no shift and no turn") {
  Random random(2);
  for (const Source& source : kAll) {
    const Molecule molecule = source.read();
    const Morph morph(molecule);
    for (int trial = 0; trial < 100; ++trial) {
      std::vector<double> t;
      for (std::size_t k = 0; k < morph.paths(); ++k) t.push_back(random.between(0, 1));
      const Positions shape = shape_at(morph, t);
      Eigen::Vector3d shift = Eigen::Vector3d::Zero(), turn = shift;
      double mass = 0, size = 0;
      for (std::size_t i = 0; i < shape.size(); ++i) {
        const double m = molecule.atoms[i]->mass;
        const Eigen::Vector3d c = molecule.conformation[i] - morph.centre();
        shift += m * shape[i];
        turn += m * c.cross(shape[i]);
        mass += m;
        size += m * c.squaredNorm();
      }
      // Sums of 77 products, each rounded.
      CHECK(shift.norm() / mass < 1e-13);
      CHECK(turn.norm() / size < 1e-14);
      // No small turn brings it nearer, and neither does a large one.
      const auto squares = [&](const Eigen::Matrix3d& r) {
        double sum = 0;
        for (std::size_t i = 0; i < shape.size(); ++i)
          sum += molecule.atoms[i]->mass *
                 (r * shape[i] - (molecule.conformation[i] - morph.centre())).squaredNorm();
        return sum;
      };
      const double least = squares(Eigen::Matrix3d::Identity());
      for (int other = 0; other < 20; ++other) {
        const Eigen::Vector3d axis = random.direction();
        const double angle = other % 2 ? 1e-3 : random.between(0, M_PI);
        CHECK(squares(Eigen::AngleAxisd(angle, axis).toRotationMatrix()) > least);
      }
    }
  }
}

TEST_CASE("one frame is enough for a path: the way there is straight in internal coordinates") {
  const std::string path = text("butane", "C1-C2-C3-C4-plus.xyz");
  const std::size_t last = path.rfind("\n14\n") + 1;
  const Molecule molecule = read_molecule(kButane.conformation(), {path.substr(last)}, {});
  REQUIRE(molecule.paths[0].nodes.size() == 2);
  const Morph morph(molecule);
  const Positions end = frames(path).back();
  CHECK(superposed_rmsd(shape_at(morph, {1}), end) < 1e-10);
  // The torsion of the carbons, atoms 1 to 4, is halfway in the middle.
  const double from = torsion(molecule.conformation, 0, 1, 2, 3), to = torsion(end, 0, 1, 2, 3);
  const double middle = torsion(shape_at(morph, {0.5}), 0, 1, 2, 3);
  CHECK(std::abs(std::remainder(2 * middle - from - to, 2 * M_PI)) < 1e-9);
}

TEST_CASE("a torsion about a line turns evenly, also where the line bends to the other side") {
  // But-2-yne. A line's middle atoms go from one side of it to the other.
  const auto butyne = [](double turned, double aside) {
    std::string out = "10\ndE=" + std::to_string(turned) + "\n";
    const auto atom = [&](const char* symbol, double x, double y, double z) {
      out += symbol + (" " + std::to_string(x)) + " " + std::to_string(y) + " " +
             std::to_string(z) + "\n";
    };
    for (const double z : {-2.06, -0.6, 0.6, 2.06}) atom("C", std::abs(z) < 1 ? aside : 0, 0, z);
    for (int h = 0; h < 6; ++h) {
      const double angle = h * 2 * M_PI / 3 + (h < 3 ? 0 : turned);
      atom("H", 1.02 * std::cos(angle), 1.02 * std::sin(angle), h < 3 ? -2.45 : 2.45);
    }
    return out;
  };
  const Morph morph(read_molecule(butyne(0, 0.05), {butyne(1, -0.05)}, {}));
  const Positions middle = shape_at(morph, {0.5});
  CHECK(torsion(middle, 4, 0, 3, 7) == Approx(0.5).margin(1e-6));
  // The middle of the line is a mean of angles here, and 0.05 Å of both sides leave less than 1 %
  // of that.
  const Eigen::Vector3d axis = (middle[3] - middle[0]).normalized();
  CHECK(axis.dot(middle[3] - middle[0]) == Approx(4.12).margin(1e-3));
  for (const int a : {1, 2}) CHECK(axis.cross(middle[a] - middle[0]).norm() < 5e-4);
}
