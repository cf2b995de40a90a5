#include "libcore/scene/pdb.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "libcore/base/error.hpp"
#include "libcore/scene/xyz.hpp"

namespace hapgrid {

namespace {

/// An element as PDB has it, in capitals; X where the label is none.
std::string element_of(const std::string& label) {
  if (!is_symbol(label) || label.size() > 2) return "X";
  std::string element = label;
  std::transform(element.begin(), element.end(), element.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return element;
}

/// Four columns, of which an element of one letter leaves the first empty.
std::string name_of(const std::string& element, std::size_t atom) {
  std::string name = element + std::to_string(atom);
  if (name.size() > 4) name = element;
  if (element.size() == 1 && name.size() < 4) name.insert(0, 1, ' ');
  return name;
}

/// In columns, to the right.
std::string right(const std::string& text, std::size_t columns) {
  return text.size() < columns ? std::string(columns - text.size(), ' ') + text : text;
}

/// Eight columns with three decimals.
std::string coordinate(double value) {
  if (!(value > -999.9994 && value < 9999.9994))
    throw Error("a coordinate is not a number from -999.999 to 9999.999, as PDB needs it");
  std::array<char, 16> digits;
  const auto end = std::to_chars(digits.begin(), digits.end(), value, std::chars_format::fixed, 3);
  return right(std::string(digits.begin(), end.ptr), 8);
}

void append_atom(std::string& text, std::size_t atom, const std::string& element,
                 const char* residue, int residue_number, const std::array<double, 3>& position) {
  std::string name = name_of(element, atom);
  name.resize(4, ' ');
  text += "HETATM" + right(std::to_string(atom % 100000), 5) + " " + name + " " + residue + " A" +
          right(std::to_string(residue_number), 4) + "    ";
  for (const double x : position) text += coordinate(x);
  text += "  1.00  0.00          " + right(element, 2) + "\n";
}

}  // namespace

void append_pdb(std::string& text, const Scene& scene, const Frame& frame,
                const std::string& hip_label, std::size_t number) {
  text += "MODEL     " + right(std::to_string(number % 10000), 4) + "\n";
  text += "REMARK   3 " + frame_comment(frame) + "\n";
  const std::size_t atoms = scene.spheres.size();
  for (std::size_t i = 0; i < atoms; ++i)
    append_atom(text, i + 1, element_of(scene.spheres[i].label), "MOL", 1,
                {frame.centres[3 * i], frame.centres[3 * i + 1], frame.centres[3 * i + 2]});
  if (!hip_label.empty())
    append_atom(text, atoms + 1, element_of(hip_label), "HIP", 2,
                {frame.position[0], frame.position[1], frame.position[2]});
  text += "ENDMDL\n";
}

}  // namespace hapgrid
