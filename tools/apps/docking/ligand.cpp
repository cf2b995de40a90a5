#include "tools/apps/docking/ligand.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <hapgrid/plugin.hpp>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace hapgrid::docking {

namespace {

// Places and charges that are this close are the same for the symmetry: force fields and
// Gasteiger's charges are not exactly symmetric.
constexpr double kSamePlace = 0.1;    // angstrom
constexpr double kSameCharge = 0.02;  // elementary charges
constexpr double kPi = 3.14159265358979323846;

Vector times(const Matrix& m, const Vector& v) {
  return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}

/// Errors begin with `whose`: of the ligand or the host.
double number(const std::string& whose, const std::string& line, std::size_t at, std::size_t size) {
  std::string word = line.size() > at ? line.substr(at, size) : "";
  word.erase(0, word.find_first_not_of(" +"));
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || !std::isfinite(value))
    throw std::runtime_error(
        whose + ": no PDBQT: a coordinate or charge is missing in: " + line.substr(0, 80));
  return value;
}

bool is_atom(const std::string& line) {
  return line.compare(0, 4, "ATOM") == 0 || line.compare(0, 6, "HETATM") == 0;
}

Atom read_atom(const std::string& whose, const std::string& line) {
  Atom atom;
  for (int a = 0; a < 3; ++a)
    atom.place[a] = number(whose, line, 30 + 8 * static_cast<std::size_t>(a), 8);
  atom.charge = number(whose, line, 70, 6);
  std::istringstream(line.size() > 77 ? line.substr(77) : "") >> atom.type;
  if (atom.type.empty()) throw std::runtime_error(whose + ": an atom of the PDBQT has no type");
  return atom;
}

bool same(const Atom& a, const Atom& b) {
  return a.type == b.type && std::abs(a.charge - b.charge) < kSameCharge;
}

/// Orthonormal axes from two places, as rows; false when they lie on one line.
bool frame(const Vector& a, const Vector& b, Matrix& axes) {
  axes[0] = a;
  for (double& c : axes[0]) c /= length(a);
  axes[2] = cross(a, b);
  const double size = length(axes[2]);
  if (!(size > 1e-3 * (1 + length(a) * length(b)))) return false;
  for (double& c : axes[2]) c /= size;
  axes[1] = cross(axes[2], axes[0]);
  return true;
}

bool carries(const Matrix& turn, const std::vector<Atom>& atoms) {
  return std::all_of(atoms.begin(), atoms.end(), [&](const Atom& atom) {
    const Vector to = times(turn, atom.place);
    return std::any_of(atoms.begin(), atoms.end(), [&](const Atom& other) {
      return same(atom, other) && length(minus(to, other.place)) < kSamePlace;
    });
  });
}

/// A bond's angle by which all atoms beyond it come to lie where others of their kind lay, as those
/// of a carboxylate after half a turn. Only such that no torsion beyond tells apart.
void find_period(const Ligand& ligand, Torsion& torsion) {
  torsion.period = 2 * kPi;
  for (const Torsion& other : ligand.torsions)
    if (&other != &torsion &&
        std::find(torsion.moved.begin(), torsion.moved.end(), other.to) != torsion.moved.end())
      return;
  Ligand part = ligand;  // which turns alone; the centre of all its atoms stays where it is
  for (const int n : {3, 2}) {
    part.torsions = {torsion};
    const double angle = 2 * kPi / n;
    std::vector<Vector> before(ligand.atoms.size()), after(ligand.atoms.size());
    const double still = 0;
    part.bend(&still, before.data());
    part.bend(&angle, after.data());
    const bool carried =
        std::all_of(torsion.moved.begin(), torsion.moved.end(), [&](std::size_t i) {
          return std::any_of(torsion.moved.begin(), torsion.moved.end(), [&](std::size_t j) {
            return same(ligand.atoms[i], ligand.atoms[j]) &&
                   length(minus(after[i], before[j])) < kSamePlace;
          });
        });
    if (!carried) continue;
    torsion.period = angle;
    return;
  }
}

/// A ligand on one line can only be carried into itself, but for turns around it, by half a turn
/// around an axis across it.
void find_symmetry_of_line(Ligand& ligand) {
  const auto farthest = std::max_element(
      ligand.atoms.begin(), ligand.atoms.end(),
      [](const Atom& a, const Atom& b) { return length(a.place) < length(b.place); });
  const double size = length(farthest->place);
  if (!(size > 0)) return;
  for (int a = 0; a < 3; ++a) ligand.axis[a] = farthest->place[a] / size;
  const Vector& u = ligand.axis;
  Vector across = std::abs(u[0]) < 0.8 ? cross(u, {1, 0, 0}) : cross(u, {0, 1, 0});
  const double scale = length(across);
  Matrix half{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      half[r][c] = 2 * across[r] * across[c] / (scale * scale) - (r == c ? 1 : 0);
  if (carries(half, ligand.atoms)) ligand.symmetry.push_back(half);
}

/// A turn is fixed by where it brings two atoms that are not on one line with the centre.
void find_symmetry(Ligand& ligand) {
  const auto& atoms = ligand.atoms;
  std::size_t first = 0, second = 0;
  double most = 0;
  for (std::size_t i = 0; i < atoms.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double area = length(cross(atoms[i].place, atoms[j].place));
      if (area > most) most = area, first = i, second = j;
    }
  Matrix from, to;
  if (!(most > 0) || !frame(atoms[first].place, atoms[second].place, from))
    return find_symmetry_of_line(ligand);
  const auto fits = [&](std::size_t from_atom, std::size_t to_atom) {
    return same(atoms[from_atom], atoms[to_atom]) &&
           std::abs(length(atoms[from_atom].place) - length(atoms[to_atom].place)) < kSamePlace;
  };
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    if (!fits(first, i)) continue;
    for (std::size_t j = 0; j < atoms.size(); ++j) {
      if (j == i || !fits(second, j) || (i == first && j == second) ||
          !frame(atoms[i].place, atoms[j].place, to))
        continue;
      Matrix turn{};
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          for (int k = 0; k < 3; ++k) turn[r][c] += to[k][r] * from[k][c];
      if (carries(turn, atoms)) ligand.symmetry.push_back(turn);
    }
  }
}

}  // namespace

double Ligand::distance(const double* a, const double* b) const {
  std::array<Vector, kMostAtoms> at_a, at_b;
  double angles[kMostTorsions];  // of b, as near to those of a as the periods allow
  for (std::size_t t = 0; t < torsions.size(); ++t)
    angles[t] = a[6 + t] + std::remainder(b[6 + t] - a[6 + t], torsions[t].period);
  bend(a + 6, at_a.data());
  bend(angles, at_b.data());
  double least = 1e300;
  for (const Matrix& turn : symmetry) {
    double sum = 0;
    for (std::size_t i = 0; i < atoms.size(); ++i) {
      Vector p, q;
      orientation::apply(a, at_a[i].data(), p.data());
      orientation::apply(b, times(turn, at_b[i]).data(), q.data());
      sum += dot(minus(p, q), minus(p, q));
    }
    least = std::min(least, sum);
  }
  return std::sqrt(least / static_cast<double>(atoms.size()));
}

void Ligand::bend(const double* angles, Vector* places) const {
  for (std::size_t i = 0; i < atoms.size(); ++i) places[i] = atoms[i].place;
  if (torsions.empty()) return;
  for (std::size_t t = 0; t < torsions.size(); ++t) {
    const Torsion& torsion = torsions[t];
    const Vector begin = places[torsion.from];
    Vector u = minus(places[torsion.to], begin);
    const double size = length(u), c = std::cos(angles[t]), s = std::sin(angles[t]);
    for (double& component : u) component /= size;
    for (const std::size_t i : torsion.moved) {  // Rodrigues' formula
      const Vector r = minus(places[i], begin), across = cross(u, r);
      const double along = dot(u, r) * (1 - c);
      for (int a = 0; a < 3; ++a) places[i][a] = begin[a] + c * r[a] + s * across[a] + along * u[a];
    }
  }
  Vector centre{};
  for (std::size_t i = 0; i < atoms.size(); ++i)
    for (int a = 0; a < 3; ++a) centre[a] += places[i][a] / static_cast<double>(atoms.size());
  for (std::size_t i = 0; i < atoms.size(); ++i) places[i] = minus(places[i], centre);
}

Ligand read_ligand(const std::string& pdbqt) {
  Ligand ligand;
  std::map<std::string, std::size_t> numbers;  // of the atoms, by those in the file
  std::vector<std::size_t> open;               // torsions beyond which the next atom lies
  std::vector<std::pair<std::string, std::string>> bonds;
  std::istringstream lines(pdbqt);
  for (std::string line; std::getline(lines, line);) {
    if (line.compare(0, 6, "BRANCH") == 0) {
      std::istringstream words(line.substr(6));
      auto& bond = bonds.emplace_back();
      words >> bond.first >> bond.second;
      open.push_back(ligand.torsions.size());
      ligand.torsions.emplace_back();
    } else if (line.compare(0, 9, "ENDBRANCH") == 0) {
      if (open.empty())
        throw std::runtime_error("ligand: no PDBQT: a branch ends that never began");
      open.pop_back();
    }
    if (!is_atom(line)) continue;
    const Atom atom = read_atom("ligand", line);
    std::string name;
    std::istringstream(line.substr(6, 5)) >> name;
    numbers[name] = ligand.atoms.size();
    for (const std::size_t t : open)
      if (name != bonds[t].second) ligand.torsions[t].moved.push_back(ligand.atoms.size());
    ligand.atoms.push_back(atom);
    if (ligand.atoms.size() > kMostAtoms)
      throw std::runtime_error("ligand: it has more than 200 atoms");
  }
  if (ligand.atoms.size() < 2)
    throw std::runtime_error("ligand: it has fewer than two atoms: nothing can turn");
  for (std::size_t t = 0; t < bonds.size(); ++t) {
    const auto from = numbers.find(bonds[t].first), to = numbers.find(bonds[t].second);
    if (from == numbers.end() || to == numbers.end() || from == to)
      throw std::runtime_error("ligand: no PDBQT: an atom of a branch is missing");
    ligand.torsions[t].from = from->second;
    ligand.torsions[t].to = to->second;
    if (!(length(minus(ligand.atoms[from->second].place, ligand.atoms[to->second].place)) > 0.1))
      throw std::runtime_error("ligand: the two atoms of a branch lie at one place");
  }
  return ligand;
}

std::vector<Atom> read_host(const std::string& pdbqt) {
  std::vector<Atom> host;
  std::istringstream lines(pdbqt);
  for (std::string line; std::getline(lines, line);) {
    if (!is_atom(line)) continue;
    host.push_back(read_atom("host", line));
    if (host.size() > kMostHostAtoms)
      throw std::runtime_error("host: it has more than " + std::to_string(kMostHostAtoms) +
                               " atoms");
  }
  if (host.empty()) throw std::runtime_error("host: it has no atoms");
  return host;
}

void keep_torsions(Ligand& ligand, const std::vector<std::size_t>& kept) {
  std::vector<Torsion> torsions;
  torsions.reserve(kept.size());
  for (const std::size_t t : kept) torsions.push_back(ligand.torsions[t]);
  ligand.torsions = std::move(torsions);
  Vector centre{};
  for (const Atom& atom : ligand.atoms)
    for (int a = 0; a < 3; ++a)
      centre[a] += atom.place[a] / static_cast<double>(ligand.atoms.size());
  for (Atom& atom : ligand.atoms) atom.place = minus(atom.place, centre);
  for (Torsion& torsion : ligand.torsions) find_period(ligand, torsion);
  ligand.symmetry = {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  if (ligand.torsions.empty()) find_symmetry(ligand);
}

std::string element_of(const std::string& type) {
  for (const char* const two : {"Cl", "Ca", "Br", "Zn", "Mg", "Mn", "Fe"})
    if (type.size() == 2 && type[0] == two[0] && (type[1] | ' ') == two[1]) return two;
  return type == "A" || type == "G" || type == "J" || type == "Q" ? "C" : type.substr(0, 1);
}

}  // namespace hapgrid::docking
