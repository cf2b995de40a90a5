#include "tools/apps/molecule/input.hpp"

#include <openbabel/atom.h>
#include <openbabel/bond.h>
#include <openbabel/mol.h>
#include <openbabel/obconversion.h>
#include <openbabel/oberror.h>
#include <openbabel/obiter.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace hapgrid::molecule {

namespace {

constexpr double kHartree = 2625.4996394799;  // kJ/mol, CODATA 2018
constexpr std::size_t kMinAtoms = 2;          // one atom has no orientation
constexpr std::size_t kMinAtomsToTurn = 4;    // fewer have no torsion

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw std::runtime_error(where + ": " + what);
}

std::string decimal(const char* format, double value) {
  char digits[64];
  std::snprintf(digits, sizeof digits, format, value);
  return digits;
}

struct Frame {
  std::vector<unsigned> numbers;  // atomic numbers
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
  const Element* element = find_element(frame.numbers[atom]);
  return std::string(element ? element->symbol : "?") + std::to_string(atom + 1);
}

bool is_sdf(const std::string& contents) {
  return contents.find("V2000") != contents.npos || contents.find("V3000") != contents.npos;
}

bool is_xyz(const std::string& contents) {
  std::istringstream lines(contents);
  std::string line;
  std::getline(lines, line);
  line.erase(std::remove_if(line.begin(), line.end(),
                            [](char c) { return c == ' ' || c == '\r' || c == '\t'; }),
             line.end());
  return !line.empty() &&
         std::all_of(line.begin(), line.end(), [](char c) { return c >= '0' && c <= '9'; });
}

Frame frame_of(OpenBabel::OBMol& mol) {
  Frame frame;
  for (unsigned i = 1; i <= mol.NumAtoms(); ++i) {
    OpenBabel::OBAtom& atom = *mol.GetAtom(static_cast<int>(i));
    frame.numbers.push_back(atom.GetAtomicNum());
    frame.positions.emplace_back(atom.GetX(), atom.GetY(), atom.GetZ());
  }
  FOR_BONDS_OF_MOL(bond, mol) {
    const int a = static_cast<int>(bond->GetBeginAtomIdx()) - 1;
    const int b = static_cast<int>(bond->GetEndAtomIdx()) - 1;
    frame.bonds.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(frame.bonds.begin(), frame.bonds.end());
  const std::string title = mol.GetTitle();
  frame.above = number_after(title, "dE=");
  frame.absolute = number_after(title, "E=");
  if (!frame.absolute) frame.absolute = number_after(title, "energy:");
  if (frame.absolute) *frame.absolute *= kHartree;
  return frame;
}

/// Checks what one frame shows without the others.
void check_frame(const Frame& frame, const std::string& where) {
  const std::size_t count = frame.positions.size();
  if (count < kMinAtoms)
    refuse(where,
           std::to_string(count) + " atoms, at least " + std::to_string(kMinAtoms) + " are needed");
  for (int a = 0; a < static_cast<int>(count); ++a) {
    if (!find_element(frame.numbers[a]))
      refuse(where, "atom " + std::to_string(a + 1) + " has the atomic number " +
                        std::to_string(frame.numbers[a]) +
                        ", for which no van der Waals radius is known");
    if (!frame.positions[a].allFinite() || frame.positions[a].norm() > 1e4)
      refuse(where, "the position of " + name(frame, a) + " is not finite or beyond 10000 Å");
    for (int b = 0; b < a; ++b) {
      const double distance = (frame.positions[a] - frame.positions[b]).norm();
      if (distance < kMinDistance)
        refuse(where, name(frame, b) + " and " + name(frame, a) + " are only " +
                          decimal("%.3g", distance) + " Å apart");
    }
  }
}

/// All frames of a text.
std::vector<Frame> read_frames(const std::string& contents, const std::string& where) {
  const char* format = is_sdf(contents) ? "sdf" : is_xyz(contents) ? "xyz" : nullptr;
  if (!format) refuse(where, "neither an XYZ nor an SDF text");
  // Its warnings would come between the lines that a filter writes.
  OpenBabel::obErrorLog.StopLogging();
  OpenBabel::OBConversion conversion;
  if (!conversion.SetInFormat(format))
    refuse(where, std::string("Open Babel has no reader of ") + format +
                      " (are its format plug-ins installed? BABEL_LIBDIR)");
  // An XYZ text has no bonds; they are found from distances, without bond orders, which take long
  // and are of no use here. When Open Babel 3.1.1 does this while it reads, it leaks the
  // coordinates; so it is asked afterwards.
  const bool perceive = format[0] == 'x';
  if (perceive) conversion.AddOption("b", OpenBabel::OBConversion::INOPTIONS);
  std::istringstream stream(contents);
  std::vector<Frame> frames;
  for (;;) {
    // Reading must go on to the text's end: a text that is damaged in the middle is no shorter one.
    stream >> std::ws;
    if (stream.eof()) break;
    OpenBabel::OBMol mol;
    const std::string here = where + " frame " + std::to_string(frames.size() + 1);
    if (!conversion.Read(&mol, &stream) || mol.NumAtoms() == 0)
      refuse(here, std::string("Open Babel cannot read it as ") + format);
    if (perceive) mol.ConnectTheDots();
    frames.push_back(frame_of(mol));
    check_frame(frames.back(), here);
  }
  if (frames.empty()) refuse(where, "no frame");
  return frames;
}

void check_connected(const Frame& frame, const std::string& where) {
  std::vector<int> part(frame.positions.size());
  for (std::size_t i = 0; i < part.size(); ++i) part[i] = static_cast<int>(i);
  // Few bonds: relabelling is fast enough.
  for (const auto& [a, b] : frame.bonds) std::replace(part.begin(), part.end(), part[b], part[a]);
  for (std::size_t i = 1; i < part.size(); ++i)
    if (part[i] != part[0])
      refuse(where, "not one molecule: no bonds lead from " + name(frame, 0) + " to " +
                        name(frame, static_cast<int>(i)));
}

void check_same_atoms(const Frame& conformation, const Frame& frame, const std::string& where) {
  if (frame.numbers.size() != conformation.numbers.size())
    refuse(where, std::to_string(frame.numbers.size()) + " atoms, the conformation has " +
                      std::to_string(conformation.numbers.size()));
  for (std::size_t i = 0; i < frame.numbers.size(); ++i)
    if (frame.numbers[i] != conformation.numbers[i])
      refuse(where, "atom " + std::to_string(i + 1) + " is " +
                        find_element(frame.numbers[i])->symbol + ", in the conformation " +
                        find_element(conformation.numbers[i])->symbol +
                        "; is the order of the atoms the same?");
  const auto check_bonds = [&](const Frame& one, const Frame& other, const char* how) {
    for (const auto& bond : one.bonds)
      if (!std::binary_search(other.bonds.begin(), other.bonds.end(), bond))
        refuse(where, name(frame, bond.first) + " and " + name(frame, bond.second) +
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
      refuse(where,
             "no energy: its title needs dE= (kJ/mol above the conformation) or E= (hartree)");
    refuse(where, "its energy is absolute, but the conformation's title has no E= (hartree)");
  }
  const double difference = *frame.absolute - *conformation.absolute;
  if (frame.above && std::abs(*frame.above - difference) > kMaxEnergiesDiffer)
    refuse(where, "dE= gives " + decimal("%.6g", *frame.above) +
                      " kJ/mol above the conformation, E= gives " + decimal("%.6g", difference) +
                      ": remove one");
  return frame.above ? *frame.above : difference;
}

/// The frame that is the conformation: the first of a path to a transition state.
std::size_t start_of(const Frame& conformation, const std::vector<Frame>& frames,
                     const std::string& where) {
  double nearest = aligned_rmsd(frames[0].positions, conformation.positions);
  for (std::size_t m = 0; m < frames.size(); ++m)
    if (aligned_rmsd(frames[m].positions, conformation.positions) <= kMaxFirstNodeRmsd) return m;
  refuse(where + " frame 1", "is not the conformation: " + decimal("%.3g", nearest) +
                                 " Å RMS apart, the limit is " + decimal("%g", kMaxFirstNodeRmsd) +
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
        refuse(here(static_cast<std::size_t>(m)),
               "is " + decimal("%.6g", -path.energies[m]) +
                   " kJ/mol below the conformation, which must be a minimum");
    }
  }
}

/// The path of one text's frames.
/// @param energy_of_last of the transition state, kJ/mol, instead of what its frame's title gives
Path path_of(const Frame& conformation, std::vector<Frame> frames, const std::string& where,
             std::optional<double> energy_of_last) {
  const auto here = [&](std::size_t m) { return where + " frame " + std::to_string(m + 1); };
  for (std::size_t m = 0; m < frames.size(); ++m)
    check_same_atoms(conformation, frames[m], here(m));
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
      refuse(here(m), "is " + decimal("%.6g", energy) +
                          " kJ/mol above the conformation, where its path must start");
  }
  find_minima(path);
  if (path.beyond()) {
    if (energy_of_last) refuse("energies", where + " goes on behind its transition state");
  } else if (const double energy = path.energies.back(); !(energy > 0)) {
    refuse(here(frames.size() - 1), "the transition state is " + decimal("%.6g", energy) +
                                        " kJ/mol above the conformation, it must be above 0");
  }
  check_climbs(path, [&](std::size_t m) { return here(m - given); });
  path.energies[path.start] = 0;
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
                       const std::vector<double>& energies) {
  const std::vector<Frame> first = read_frames(conformation_text, "conformation");
  if (first.size() != 1)
    refuse("conformation", std::to_string(first.size()) + " frames, it must be one");
  const Frame& conformation = first[0];
  check_connected(conformation, "conformation");
  if (!transition_states.empty() && first[0].positions.size() < kMinAtomsToTurn)
    refuse("conformation", std::to_string(first[0].positions.size()) +
                               " atoms have no torsion: transition_states must be empty");
  if (!energies.empty() && energies.size() != transition_states.size())
    refuse("energies", std::to_string(energies.size()) + " numbers for " +
                           std::to_string(transition_states.size()) + " transition states");

  Molecule molecule;
  for (const unsigned number : conformation.numbers) molecule.atoms.push_back(find_element(number));
  molecule.bonds = conformation.bonds;
  molecule.conformation = conformation.positions;
  for (std::size_t k = 0; k < transition_states.size(); ++k) {
    const std::string where = "transition_states[" + std::to_string(k) + "]";
    molecule.paths.push_back(path_of(conformation, read_frames(transition_states[k], where), where,
                                     energies.empty() ? std::nullopt : std::optional(energies[k])));
  }
  return molecule;
}

}  // namespace hapgrid::molecule
