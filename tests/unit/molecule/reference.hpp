// Molecules for tests, and geometry from outside the code: frames read line by line, torsions from
// cross products, superposition by singular values.
#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <sstream>
#include <stdexcept>

#include "libcore/model/plugin_model.hpp"
#include "tests/unit/catch.hpp"
#include "tools/apps/molecule/energy.hpp"
#include "tools/apps/molecule/input.hpp"

namespace molecules {

using hapgrid::molecule::EnergyParameters;
using hapgrid::molecule::HybridEnergy;
using hapgrid::molecule::Molecule;
using hapgrid::molecule::Morph;
using hapgrid::molecule::Positions;
using hapgrid::molecule::read_molecule;

inline std::string text(const std::string& molecule, const std::string& file) {
  std::ifstream in(HAPGRID_SOURCE_DIR "/examples/molecule/" + molecule + "/" + file);
  if (!in) throw std::runtime_error("no " + molecule + "/" + file);
  std::ostringstream contents;
  contents << in.rdbuf();
  return contents.str();
}

struct Source {
  std::string name;
  std::vector<std::string> paths;

  std::string conformation() const { return text(name, "conformation.xyz"); }
  std::vector<std::string> transition_states() const {
    std::vector<std::string> texts;
    for (const std::string& path : paths) texts.push_back(text(name, path));
    return texts;
  }
  Molecule read() const { return read_molecule(conformation(), transition_states(), {}); }
  std::unique_ptr<hapgrid::Model> make(std::vector<hapgrid::Parameter> parameters = {}) const {
    parameters.push_back({"conformation", conformation()});
    parameters.push_back({"transition_states", transition_states()});
    return hapgrid::Plugin("molecule", {HAPGRID_BUILD_DIR "/models"}).create(parameters);
  }
};

inline const Source kButane{"butane", {"C1-C2-C3-C4-plus.xyz", "H5-C1-C2-C3.xyz"}};
inline const Source kOnePath{"butane", {"C1-C2-C3-C4-plus.xyz"}};
inline const Source kDipeptide{"alanine-dipeptide",
                               {"phi-plus.xyz", "psi-plus.xyz", "chi1.xyz", "C7-N9-C10-H20.xyz"}};
// Phenylalanine and tyrosine: two rings.
inline const Source kEnkephalin{
    "leu-enkephalin",
    {"chi1_1-minus.xyz", "psi2-plus.xyz", "chi4_1-minus.xyz", "chi5_1-minus.xyz"}};
inline const std::vector<Source> kAll{kOnePath, kButane, kDipeptide, kEnkephalin};

/// The positions of every frame of an XYZ text.
inline std::vector<Positions> frames(const std::string& xyz) {
  std::istringstream in(xyz);
  std::vector<Positions> frames;
  std::size_t count = 0;
  for (std::string line; in >> count;) {
    std::getline(in, line);
    std::getline(in, line);
    frames.emplace_back();
    for (std::size_t i = 0; i < count; ++i) {
      std::string symbol;
      Eigen::Vector3d p;
      in >> symbol >> p.x() >> p.y() >> p.z();
      frames.back().push_back(p);
    }
  }
  return frames;
}

/// The numbers after dE= of every frame, kJ/mol.
inline std::vector<double> energies(const std::string& xyz) {
  std::vector<double> found;
  std::istringstream lines(xyz);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("dE=", 0) == 0) found.push_back(std::stod(line.substr(3)));
  return found;
}

/// The points as columns.
inline Eigen::Map<const Eigen::Matrix3Xd> columns(const Positions& p) {
  return {p[0].data(), 3, static_cast<Eigen::Index>(p.size())};
}

/// The RMS distance, Å.
inline double rmsd(const Positions& a, const Positions& b) {
  return (columns(a) - columns(b)).norm() / std::sqrt(static_cast<double>(a.size()));
}

/// a superposed on b, unweighted; the RMS distance that is left, Å.
inline double superposed_rmsd(Positions a, const Positions& b) {
  const Eigen::Matrix4d to_b = Eigen::umeyama(columns(a), columns(b), false);
  for (Eigen::Vector3d& x : a) x = (to_b * x.homogeneous()).head<3>();
  return rmsd(a, b);
}

inline double torsion(const Positions& p, int a, int b, int c, int d) {
  const Eigen::Vector3d u = p[b] - p[a], v = p[c] - p[b], w = p[d] - p[c];
  const Eigen::Vector3d m = u.cross(v), n = v.cross(w);
  return std::atan2(v.norm() * u.dot(n), m.dot(n));
}

inline Positions positions(HybridEnergy& energy, const std::vector<double>& s) {
  std::vector<double> p(3 * energy.morph().atoms());
  energy.positions(s.data(), p.data());
  Positions out;
  for (std::size_t i = 0; i < p.size(); i += 3) out.emplace_back(p[i], p[i + 1], p[i + 2]);
  return out;
}

using State = std::vector<double>;

inline State convert(hapgrid::Model& model, const State& s, const hapgrid::Vec3& x,
                     const hapgrid::Vec3& d) {
  State result(s.size());
  INFO(model.error());
  REQUIRE(model.convert(s.data(), x, d, result.data()));
  return result;
}

/// The same numbers everywhere.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double between(double a, double b) { return a + (b - a) * (engine_() / 4294967296.0); }
  std::size_t below(std::size_t n) { return engine_() % n; }
  Eigen::Vector3d direction() {
    return Eigen::Vector3d(between(-1, 1), between(-1, 1), between(-1, 1)).normalized();
  }

  /// A state: t anywhere, or held at 0 for half of them, shifts and turns moderate.
  std::vector<double> state(const HybridEnergy& energy) {
    std::vector<double> s(energy.variables());
    const std::size_t paths = energy.morph().paths();
    for (std::size_t i = 0; i < s.size(); ++i) {
      s[i] = i < paths ? between(0, 1) : between(-0.4, 0.4);
      if (i < paths && below(2)) s[i] = 0;
    }
    return s;
  }

 private:
  std::mt19937 engine_;
};

}  // namespace molecules
