// A rigid ligand in a host (docking): the HIP is the ligand's centre, its orientation is the state.
#include <cstdio>
#include <hapgrid/plugin.hpp>
#include <string>
#include <vector>

#include "examples/docking/pose.hpp"

namespace {

using namespace hapgrid::docking;
namespace table = hapgrid::table;

constexpr double kMaxShift = 8;                                // angstrom
constexpr double kGoldenAngle = 2.39996, kHalfTurn = 3.14159;  // rad

std::vector<table::Lattice> read_maps(const std::vector<std::string>& texts) {
  std::vector<table::Lattice> maps;
  for (std::size_t m = 0; m < texts.size(); ++m)
    maps.push_back(table::read_lattice(texts[m], "map " + std::to_string(m + 1)));
  if (maps.empty()) throw std::runtime_error("maps: there are none");
  return maps;
}

class DockingModel {
 public:
  explicit DockingModel(hapgrid::PluginParameters& parameters)
      : DockingModel(parameters, read_maps(parameters.texts("maps"))) {}

 private:
  DockingModel(hapgrid::PluginParameters& parameters, const std::vector<table::Lattice>& maps)
      : poses_(read_ligand(parameters.text("ligand", "")), parameters.texts("types"), maps,
               parameters.positive("soft", 10)),
        host_(maps[0].atoms),
        tolerance_(parameters.positive("tolerance", 0.1)),
        substep_(parameters.positive("substep", 0.1)),
        force_scale_(parameters.positive("force_scale", 0.02)) {
    parameters.finish();
  }

 public:
  hapgrid_model_info info() const {
    hapgrid_model_info info{};
    info.state_size = 6;
    info.d_max = kMaxShift;
    info.tolerance = tolerance_;
    std::snprintf(info.tolerance_unit, sizeof info.tolerance_unit, "angstrom RMSD");
    std::snprintf(info.length_unit, sizeof info.length_unit, "angstrom");
    std::snprintf(info.energy_unit, sizeof info.energy_unit, "kJ/mol");
    info.force_scale = force_scale_;
    info.spheres = static_cast<std::uint32_t>(poses_.ligand().atoms.size() + host_.size());
    return info;
  }

  void periods(double* periods) const { std::fill_n(periods, 6, HAPGRID_ROTATION); }

  /// Comes to rest from the orientation in the ligand's file and many others, and takes what
  /// differs.
  std::vector<double> known_states(const double* x) const {
    std::vector<double> known;
    for (int n = -1; n < kStarts; ++n) {
      double s[6] = {1, 0, 0, 0, 1, 0};
      // Axes on a spiral around the sphere by the golden angle, which spreads them evenly, and
      // angles up to pi in another order: 7 and kStarts have no common factor.
      const double z = 1 - (2 * n + 1.0) / kStarts, r = std::sqrt(std::max(0.0, 1 - z * z)),
                   turned = kGoldenAngle * n;
      const double angle = kHalfTurn * ((n * 7) % kStarts + 0.5) / kStarts;
      const double turn[3] = {angle * r * std::cos(turned), angle * r * std::sin(turned),
                              angle * z};
      if (n >= 0) hapgrid::orientation::turn(s, turn);
      poses_.relax(x, s);
      poses_.choose(s);
      bool is_new = true;
      for (std::size_t k = 0; k < known.size(); k += 6) is_new = is_new && !equal(&known[k], s);
      if (is_new) known.insert(known.end(), s, s + 6);
    }
    return known;
  }

  void convert(const double* s, const double* x, const double* d, double* result) const {
    std::copy_n(s, 6, result);
    const double way = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const int steps = static_cast<int>(std::ceil(way / substep_ - 1e-9));
    for (int k = 1; k <= steps; ++k) {
      const double part = static_cast<double>(k) / steps;
      const double at[3] = {x[0] + part * d[0], x[1] + part * d[1], x[2] + part * d[2]};
      poses_.relax(at, result);
    }
    if (steps > 0) poses_.choose(result);
  }

  bool equal(const double* a, const double* b) const {
    return std::equal(a, a + 6, b) || poses_.ligand().distance(a, b) <= tolerance_;
  }

  /// At a minimum the energy does not change with the orientation, so its slope by x alone is the
  /// slope along the branch.
  void force(const double* x, const double* s, double* f) const {
    poses_.energy(x, s, f);
    for (int a = 0; a < 3; ++a) f[a] *= -force_scale_;
  }

  double energy(const double* x, const double* s) const { return poses_.energy(x, s, nullptr); }

  void spheres(hapgrid_sphere* spheres) const {
    const auto show = [&](const std::string& element, float size) {
      hapgrid_sphere& sphere = *spheres++;
      table::look_of(element, sphere.radius, sphere.colour);
      sphere.radius *= size;
      std::snprintf(sphere.label, sizeof sphere.label, "%s", element.c_str());
    };
    for (const LigandAtom& atom : poses_.ligand().atoms) show(element_of(atom.type), 0.5F);
    for (const table::Atom& atom : host_) show(atom.label, 0.25F);
  }

  void shape(const double* x, const double* s, float* centres) const {
    for (const LigandAtom& atom : poses_.ligand().atoms) {
      double place[3];
      hapgrid::orientation::apply(s, atom.place.data(), place);
      for (int a = 0; a < 3; ++a) *centres++ = static_cast<float>(x[a] + place[a]);
    }
    for (const table::Atom& atom : host_)
      for (const double c : atom.position) *centres++ = static_cast<float>(c);
  }

 private:
  static constexpr int kStarts = 60;

  Poses poses_;
  std::vector<table::Atom> host_;
  double tolerance_, substep_, force_scale_;
};

}  // namespace

HAPGRID_MODEL_PLUGIN(DockingModel, "a rigid ligand that turns in a host, by AutoGrid's maps")
