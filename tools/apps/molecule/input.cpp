#include "tools/apps/molecule/input.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace hapgrid::molecule {

namespace {

constexpr double kHartree = 2625.4996394799;  // kJ/mol, CODATA 2018
constexpr double kBonded =
    1.25;  // nearer than so many sums of covalent radii: as `hapgrid molecule` has it
constexpr std::size_t kMinAtoms = 2;         // one atom has no orientation
constexpr std::size_t kMinAtomsToTurn = 4;   // fewer have no torsion
constexpr std::size_t kMinAtomsToReact = 3;  // fewer have no orientation

[[noreturn]] void refuse_text(const std::string& where, const std::string& what) {
  throw std::runtime_error(where + ": " + what);
}

std::string formatted(const char* format, double value) {
  char digits[64];
  std::snprintf(digits, sizeof digits, format, value);
  return digits;
}

struct Frame {
  std::vector<const Element*> atoms;
  Positions positions;
  std::vector<std::pair<int, int>> bonds;
  std::optional<double> above;     // kJ/mol above the conformation
  std::optional<double> absolute;  // kJ/mol
};

/// The number after `key` where it begins a word of `title`. Locale-independent.
std::optional<double> number_after(std::string_view title, std::string_view key) {
  for (std::size_t at = title.find(key); at != title.npos; at = title.find(key, at + 1)) {
    if (at > 0 && !std::strchr(" \t,;(", title[at - 1])) continue;
    std::string_view rest = title.substr(at + key.size());
    while (!rest.empty() && (rest.front() == ' ' || rest.front() == '\t')) rest.remove_prefix(1);
    if (!rest.empty() && rest.front() == '+') rest.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error == std::errc() && std::isfinite(value)) return value;
  }
  return std::nullopt;
}

/// An atom as editors show it, "C3": the symbol and the number counted from 1.
std::string name(const Frame& frame, int atom) {
  return frame.atoms[atom]->symbol + std::to_string(atom + 1);
}

/// Takes the next line off a text.
std::string_view next_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(line.size() + 1, text.size()));
  return line;
}

/// Takes the next word off a line; empty where there is none.
std::string_view next_word(std::string_view& line) {
  constexpr std::string_view kBlanks = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

/// Whether a word is a number and nothing else, whatever the locale.
template <class Number>
bool read_number(std::string_view word, Number& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

/// Takes a frame off an XYZ text: the number of atoms, the title, and a line for each atom, whose
/// further words are left out.
Frame next_frame(std::string_view& text, const std::string& where) {
  std::string_view first = next_line(text);
  std::size_t count = 0;
  if (!read_number(next_word(first), count) || !next_word(first).empty())
    refuse_text(where, "no XYZ text: it must begin with a line that has the number of atoms");
  const std::string_view title = next_line(text);
  Frame frame;
  frame.above = number_after(title, "dE=");
  frame.absolute = number_after(title, "E=");
  if (!frame.absolute) frame.absolute = number_after(title, "energy:");
  if (frame.absolute) *frame.absolute *= kHartree;
  while (frame.atoms.size() < count) {
    std::string_view line = next_line(text);
    const std::string atom = "atom " + std::to_string(frame.atoms.size() + 1);
    const std::string_view symbol = next_word(line);
    Eigen::Vector3d& position = frame.positions.emplace_back();
    for (double& x : position)
      if (!read_number(next_word(line), x))
        refuse_text(where, atom + " is no line with a symbol and three numbers");
    frame.atoms.push_back(find_element(symbol));
    if (!frame.atoms.back())
      refuse_text(where, atom + " is no element whose van der Waals radius is known");
  }
  return frame;
}

/// Bonds by distances, each pair ascending, sorted.
std::vector<std::pair<int, int>> bonds_of(const Frame& frame) {
  std::vector<std::pair<int, int>> bonds;
  for (int a = 0; a < static_cast<int>(frame.atoms.size()); ++a)
    for (int b = a + 1; b < static_cast<int>(frame.atoms.size()); ++b)
      if ((frame.positions[a] - frame.positions[b]).norm() <
          kBonded * (frame.atoms[a]->covalent + frame.atoms[b]->covalent))
        bonds.emplace_back(a, b);
  return bonds;
}

/// Checks what one frame shows without the others.
void check_frame(const Frame& frame, const std::string& where) {
  const std::size_t count = frame.positions.size();
  if (count < kMinAtoms)
    refuse_text(where, std::to_string(count) + " atoms, at least " + std::to_string(kMinAtoms) +
                           " are needed");
  for (int a = 0; a < static_cast<int>(count); ++a) {
    if (!frame.positions[a].allFinite() || frame.positions[a].norm() > 1e4)
      refuse_text(where, "the position of " + name(frame, a) + " is not finite or beyond 10000 Å");
    for (int b = 0; b < a; ++b) {
      const double distance = (frame.positions[a] - frame.positions[b]).norm();
      if (distance < kMinDistance)
        refuse_text(where, name(frame, b) + " and " + name(frame, a) + " are only " +
                               formatted("%.3g", distance) + " Å apart");
    }
  }
}

/// All frames of a text, to its end: one that is damaged in the middle is no shorter one.
std::vector<Frame> read_frames(std::string_view text, const std::string& where) {
  std::vector<Frame> frames;
  constexpr std::string_view kSpace = " \t\r\n";
  while (text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size())), !text.empty()) {
    const std::string here = where + " frame " + std::to_string(frames.size() + 1);
    frames.push_back(next_frame(text, here));
    check_frame(frames.back(), here);
    frames.back().bonds = bonds_of(frames.back());
  }
  if (frames.empty()) refuse_text(where, "no frame of an XYZ text");
  return frames;
}

void check_connected(const Frame& frame, const std::string& where) {
  std::vector<int> part(frame.positions.size());
  for (std::size_t i = 0; i < part.size(); ++i) part[i] = static_cast<int>(i);
  // Few bonds: relabelling is fast enough.
  for (const auto& [a, b] : frame.bonds) {
    const int from = part[b], to = part[a];  // std::replace changes what it would refer to
    std::replace(part.begin(), part.end(), from, to);
  }
  for (std::size_t i = 1; i < part.size(); ++i)
    if (part[i] != part[0])
      refuse_text(where, "not one molecule: no bonds lead from " + name(frame, 0) + " to " +
                             name(frame, static_cast<int>(i)));
}

void check_same_atoms(const Frame& conformation, const Frame& frame, const std::string& where,
                      bool bonds_change) {
  if (frame.atoms.size() != conformation.atoms.size())
    refuse_text(where, std::to_string(frame.atoms.size()) + " atoms, the conformation has " +
                           std::to_string(conformation.atoms.size()));
  for (std::size_t i = 0; i < frame.atoms.size(); ++i)
    if (frame.atoms[i] != conformation.atoms[i])
      refuse_text(where, "atom " + std::to_string(i + 1) + " is " + frame.atoms[i]->symbol +
                             ", in the conformation " + conformation.atoms[i]->symbol +
                             "; is the order of the atoms the same?");
  if (bonds_change) return;
  const auto check_bonds = [&](const Frame& one, const Frame& other, const char* how) {
    for (const auto& bond : one.bonds)
      if (!std::binary_search(other.bonds.begin(), other.bonds.end(), bond))
        refuse_text(where, name(frame, bond.first) + " and " + name(frame, bond.second) +
                               " are bonded " + how + "; is the order of the atoms the same?");
  };
  check_bonds(conformation, frame, "in the conformation but not here");
  check_bonds(frame, conformation, "here but not in the conformation");
}

/// The energy above the conformation, kJ/mol.
double energy_above(const Frame& conformation, const Frame& frame, const std::string& where) {
  if (!frame.absolute || !conformation.absolute) {
    if (frame.above) return *frame.above;
    if (!frame.absolute)
      refuse_text(where,
                  "no energy: its title needs dE= (kJ/mol above the conformation) or E= (hartree)");
    refuse_text(where, "its energy is absolute, but the conformation's title has no E= (hartree)");
  }
  const double difference = *frame.absolute - *conformation.absolute;
  if (frame.above && std::abs(*frame.above - difference) > kMaxEnergiesDiffer)
    refuse_text(where, "dE= gives " + formatted("%.6g", *frame.above) +
                           " kJ/mol above the conformation, E= gives " +
                           formatted("%.6g", difference) + ": remove one");
  return frame.above ? *frame.above : difference;
}

/// The frame that is the conformation: the first of a path to a transition state.
std::size_t start_of(const Frame& conformation, const std::vector<Frame>& frames,
                     const std::string& where) {
  double nearest = aligned_rmsd(frames[0].positions, conformation.positions);
  for (std::size_t m = 0; m < frames.size(); ++m)
    if (aligned_rmsd(frames[m].positions, conformation.positions) <= kMaxFirstNodeRmsd) return m;
  refuse_text(where + " frame 1", "is not the conformation: " + formatted("%.3g", nearest) +
                                      " Å RMS apart, the limit is " +
                                      formatted("%g", kMaxFirstNodeRmsd) +
                                      "; no other frame is it");
}

/// Finds the minima behind saddles, going from the conformation either way.
void find_minima(Path& path) {
  const auto last = static_cast<int>(path.nodes.size()) - 1;
  for (const int step : {-1, 1}) {
    bool climbs = true;
    double foot = 0;                                       // of the slope to the top
    int top = static_cast<int>(path.start), bottom = top;  // the extrema since the last of the kind
    for (int m = top + step; m >= 0 && m <= last; m += step) {
      const std::vector<double>& e = path.energies;
      if (e[m] > e[top]) top = m;
      const bool falls = e[top] - std::max(e[m], foot) > kMinDepth;
      if (climbs ? falls : e[m] < e[bottom]) climbs = false, bottom = m;
      const bool ends = m == 0 || m == last;
      if (climbs || (!ends && e[m] - e[bottom] <= kMinDepth)) continue;
      path.minima.push_back(static_cast<std::size_t>(bottom));
      climbs = true, top = m, foot = e[bottom];
    }
  }
  std::sort(path.minima.begin(), path.minima.end());
}

/// A node below the conformation with no saddle between shows that this is no minimum.
template <class Where>
void check_climbs(const Path& path, const Where& here) {
  for (const int step : {-1, 1}) {
    double highest = 0;
    for (int m = static_cast<int>(path.start);
         m >= 0 && m < static_cast<int>(path.nodes.size()) && highest <= kMinDepth; m += step) {
      highest = std::max(highest, path.energies[m]);
      if (path.energies[m] < -kMaxEnergyBelow)
        refuse_text(here(static_cast<std::size_t>(m)),
                    "is " + formatted("%.6g", -path.energies[m]) +
                        " kJ/mol below the conformation, which must be a minimum");
    }
  }
}

/// The path of one text's frames.
/// @param energy_of_last of the transition state, kJ/mol, instead of what its frame's title gives
Path path_of(const Frame& conformation, std::vector<Frame> frames, const std::string& where,
             std::optional<double> energy_of_last, bool bonds_change) {
  const auto here = [&](std::size_t m) { return where + " frame " + std::to_string(m + 1); };
  for (std::size_t m = 0; m < frames.size(); ++m)
    check_same_atoms(conformation, frames[m], here(m), bonds_change);
  Path path;
  if (frames.size() == 1) {
    path.nodes.push_back(conformation.positions);
    path.energies.push_back(0);
  } else {
    path.start = start_of(conformation, frames, where);
  }
  const std::size_t given = path.nodes.size();  // whether the conformation is no frame
  for (std::size_t m = 0; m < frames.size(); ++m) {
    const bool last = m + 1 == frames.size();
    path.nodes.push_back(std::move(frames[m].positions));
    const double energy =
        last && energy_of_last ? *energy_of_last : energy_above(conformation, frames[m], here(m));
    path.energies.push_back(energy);
    if (m == path.start && given == 0 && energy > kMaxEnergyBelow)
      refuse_text(here(m), "is " + formatted("%.6g", energy) +
                               " kJ/mol above the conformation, where its path must start");
  }
  find_minima(path);
  if (path.beyond()) {
    if (energy_of_last) refuse_text("energies", where + " goes on behind its transition state");
  } else if (const double energy = path.energies.back(); !(energy > 0)) {
    refuse_text(here(frames.size() - 1), "the transition state is " + formatted("%.6g", energy) +
                                             " kJ/mol above the conformation, it must be above 0");
  }
  check_climbs(path, [&](std::size_t m) { return here(m - given); });
  path.energies[path.start] = 0;
  path.closes = path.beyond() && path.energies.front() == path.energies.back() &&
                aligned_rmsd(path.nodes.front(), path.nodes.back()) <= kMaxEndsRmsd;
  return path;
}

}  // namespace

double aligned_rmsd(const Positions& a, const Positions& b) {
  const auto n = static_cast<Eigen::Index>(a.size());
  Eigen::Matrix3Xd p(3, n), q(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    p.col(i) = a[static_cast<std::size_t>(i)];
    q.col(i) = b[static_cast<std::size_t>(i)];
  }
  p.colwise() -= p.rowwise().mean().eval();
  q.colwise() -= q.rowwise().mean().eval();
  const Eigen::Matrix3d h = p * q.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(h, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d v = svd.matrixV();
  if ((v * svd.matrixU().transpose()).determinant() < 0) v.col(2) *= -1;
  const Eigen::Matrix3d rotation = v * svd.matrixU().transpose();
  return std::sqrt((rotation * p - q).squaredNorm() / static_cast<double>(n));
}

Molecule read_molecule(const std::string& conformation_text,
                       const std::vector<std::string>& transition_states,
                       const std::vector<double>& energies, bool bonds_change) {
  const std::vector<Frame> first = read_frames(conformation_text, "conformation");
  if (first.size() != 1)
    refuse_text("conformation", std::to_string(first.size()) + " frames, it must be one");
  const Frame& conformation = first[0];
  if (!bonds_change) check_connected(conformation, "conformation");
  const std::size_t least = bonds_change ? kMinAtomsToReact : kMinAtomsToTurn;
  if (!transition_states.empty() && first[0].positions.size() < least)
    refuse_text("conformation", std::to_string(first[0].positions.size()) +
                                    " atoms have no torsion: transition_states must be empty");
  if (!energies.empty() && energies.size() != transition_states.size())
    refuse_text("energies", std::to_string(energies.size()) + " numbers for " +
                                std::to_string(transition_states.size()) + " transition states");

  Molecule molecule;
  molecule.atoms = conformation.atoms;
  molecule.bonds = conformation.bonds;
  molecule.conformation = conformation.positions;
  molecule.bonds_change = bonds_change;
  for (std::size_t k = 0; k < transition_states.size(); ++k) {
    const std::string where = "transition_states[" + std::to_string(k) + "]";
    std::vector<Frame> frames = read_frames(transition_states[k], where);
    if (bonds_change)
      for (const Frame& frame : frames)
        molecule.bonds.insert(molecule.bonds.end(), frame.bonds.begin(), frame.bonds.end());
    molecule.paths.push_back(path_of(conformation, std::move(frames), where,
                                     energies.empty() ? std::nullopt : std::optional(energies[k]),
                                     bonds_change));
  }
  std::sort(molecule.bonds.begin(), molecule.bonds.end());
  molecule.bonds.erase(std::unique(molecule.bonds.begin(), molecule.bonds.end()),
                       molecule.bonds.end());
  return molecule;
}

}  // namespace hapgrid::molecule
