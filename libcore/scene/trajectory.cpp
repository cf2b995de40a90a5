#include "libcore/scene/trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/table.hpp"
#include "libcore/base/text.hpp"
#include "libcore/scene/bonds.hpp"

namespace hapgrid {

namespace {

// <cctype> depends on the locale.
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string triple(const Vec3& v) {
  return format("{},{},{}", to_text(v[0]), to_text(v[1]), to_text(v[2]));
}

/// The comment of a frame, without an end of line.
std::string comment(const Frame& frame) {
  const std::string text = format("time={} tick={} hip={} force={}", to_text(frame.time_s),
                                  frame.tick, triple(frame.hip), triple(frame.force));
  return std::isnan(frame.energy) ? text : format("{} energy={}", text, to_text(frame.energy));
}

/// The units of a comment as one more word of it; in quotes, since it has blanks.
std::string units(const Scene& scene, const Frame& frame) {
  std::string names = format("time s, hip {}, force N", unit_sign(scene.length_unit));
  if (!std::isnan(frame.energy)) names += format(", energy {}", unit_sign(scene.energy_unit));
  std::replace(names.begin(), names.end(), '"', '\'');
  return format(" units=\"{}\"", printable_line(names));
}

/// Fixed notation: some readers of XYZ know no exponents. Six decimals are below a float's
/// resolution from 16 units on, and finer than any picture of atoms before.
void append_xyz_coordinate(std::string& text, double value) {
  if (!std::isfinite(value)) throw Error("a coordinate is not finite");
  text += ' ';
  text += fixed(value, 6);
}

/// An element as PDB has it, in capitals; X if the label is none.
std::string element_of(const std::string& label) {
  if (!is_symbol(label) || label.size() > 2) return "X";
  std::string element = label;
  std::transform(element.begin(), element.end(), element.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return element;
}

/// A name of at most four columns; an element of one letter leaves the first of them empty.
std::string pdb_name(const std::string& element, std::size_t atom) {
  std::string name = format("{}{}", element, atom);
  if (name.size() > 4) name = element;
  if (element.size() == 1 && name.size() < 4) name.insert(0, 1, ' ');
  return name;
}

/// Eight columns with three decimals.
std::string pdb_coordinate(double value) {
  if (!(value > -999.9994 && value < 9999.9994))
    throw Error("a coordinate is not a number from -999.999 to 9999.999, as PDB needs it");
  return right(fixed(value, 3), 8);
}

void append_pdb_atom(std::string& text, std::size_t atom, const std::string& element,
                     const char* residue, int residue_number, const Vec3& position) {
  text +=
      format("HETATM{:>5} {:<4} {} A{:>4}    {}{}{}  1.00  0.00          {:>2}\n", atom % 100000,
             pdb_name(element, atom), residue, residue_number, pdb_coordinate(position[0]),
             pdb_coordinate(position[1]), pdb_coordinate(position[2]), element);
}

}  // namespace

bool is_symbol(const std::string& label) {
  return !label.empty() && is_letter(label[0]) &&
         std::all_of(label.begin(), label.end(),
                     [](char c) { return is_letter(c) || is_digit(c); });
}

void append_xyz(std::string& text, const Scene& scene, const Frame& frame,
                const std::string& hip_label) {
  const bool with_hip = !hip_label.empty();
  text += format("{}\n{}\n", scene.spheres.size() + (with_hip ? 1 : 0),
                 comment(frame) + units(scene, frame));
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const std::string& label = scene.spheres[i].label;
    text += is_symbol(label) ? label : "X";
    for (int a = 0; a < 3; ++a) append_xyz_coordinate(text, frame.centres[3 * i + a]);
    text += '\n';
  }
  if (!with_hip) return;
  text += hip_label;
  for (const double x : frame.position) append_xyz_coordinate(text, x);
  text += '\n';
}

void append_pdb(std::string& text, const Scene& scene, const Frame& frame,
                const std::string& hip_label, std::size_t number) {
  text += format("MODEL     {:>4}\nREMARK   3 {}\n", number % 10000, comment(frame));
  const std::size_t atoms = scene.spheres.size();
  for (std::size_t i = 0; i < atoms; ++i)
    append_pdb_atom(text, i + 1, element_of(scene.spheres[i].label), "MOL", 1,
                    {frame.centres[3 * i], frame.centres[3 * i + 1], frame.centres[3 * i + 2]});
  if (!hip_label.empty())
    append_pdb_atom(text, atoms + 1, element_of(hip_label), "HIP", 2, frame.position);
  text += "ENDMDL\n";
}

void append_pdb_bonds(std::string& text, const Scene& scene, const Frame& frame) {
  constexpr std::size_t kBondsOfALine = 4;
  std::vector<std::vector<std::size_t>> near(scene.spheres.size());
  for (const auto& [i, j] : find_bonds(scene, frame)) {
    near[i].push_back(j);
    near[j].push_back(i);
  }
  for (std::size_t i = 0; i < near.size(); ++i)
    for (std::size_t k = 0; k < near[i].size(); ++k) {
      if (k % kBondsOfALine == 0) text += format("{}CONECT{:>5}", k == 0 ? "" : "\n", i + 1);
      text += format("{:>5}{}", near[i][k] + 1, k + 1 == near[i].size() ? "\n" : "");
    }
}

}  // namespace hapgrid
