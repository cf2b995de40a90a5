#include "tools/apps/molecule/minima.hpp"

#include <algorithm>
#include <cmath>

#include "tools/apps/molecule/conversion.hpp"

namespace hapgrid::molecule {

std::vector<std::vector<double>> combined_minima(const Molecule& molecule) {
  std::vector<std::vector<double>> all{std::vector<double>(molecule.paths.size())};
  for (std::size_t k = 0; k < molecule.paths.size(); ++k) {
    const Path& path = molecule.paths[k];
    const std::size_t before = all.size();
    for (const std::size_t node : path.minima)
      for (std::size_t i = 0; i < (molecule.bonds_change ? 1 : before) && all.size() <= kMaxMinima;
           ++i) {
        std::vector<double> t = all[i];
        t[k] = path.t(node);
        all.push_back(t);
      }
  }
  return all;
}

Minima::Minima(const Molecule& molecule, HybridEnergy& energy) {
  held_ = !energy.parameters().hold.empty();
  for (std::size_t k = 0; k < energy.morph().paths(); ++k) closes_.push_back(energy.closes(k));
  for (std::size_t i = 0; i < energy.variables(); ++i) scale_.push_back(energy.scale(i));
  for (const Element* element : molecule.atoms)
    reach_.push_back(element->radius + energy.parameters().probe_radius);
  for (std::vector<double>& t : combined_minima(molecule)) {
    for (double& value : t) value = rounded_state(value);
    t.resize(energy.variables());
    std::vector<double> positions(3 * molecule.atoms.size());
    energy.positions(t.data(), positions.data());
    // The conformation is as its text has it, to the last digit.
    if (states_.empty())
      for (std::size_t i = 0; i < molecule.atoms.size(); ++i)
        std::copy_n(molecule.conformation[i].data(), 3, &positions[3 * i]);
    states_.push_back(t);
    positions_.push_back(positions);
  }
}

std::array<double, 3> Minima::centre(std::size_t minimum, const std::vector<int>& atoms) const {
  std::array<double, 3> centre{};
  for (const int atom : atoms)
    for (int a = 0; a < 3; ++a)
      centre[a] += positions_[minimum][3 * atom + a] / static_cast<double>(atoms.size());
  return centre;
}

bool Minima::touched(std::size_t minimum, const double* x) const {
  if (held_) return true;
  const double* a = positions_[minimum].data();
  for (const double reach : reach_) {
    const double d[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]};
    if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach) return true;
    a += 3;
  }
  return false;
}

std::size_t Minima::near(const double* s, double limit) const {
  for (std::size_t m = 0; m < states_.size(); ++m) {
    double distance = 0;
    for (std::size_t i = 0; i < scale_.size(); ++i)
      distance = std::max(distance, std::abs(difference(i, s[i] - states_[m][i]) * scale_[i]));
    if (distance <= limit) return m;
  }
  return states_.size();
}

}  // namespace hapgrid::molecule
