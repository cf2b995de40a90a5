#include "libcore/scene/pdb.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

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

void append_atom(std::string& text, std::size_t atom, const std::string& element,
                 const char* residue, int residue_number, const std::array<double, 3>& position) {
  for (const double x : position)
    if (!(x > -999.9994 && x < 9999.9994))
      throw Error("a coordinate is not a number from -999.999 to 9999.999, as PDB needs it");
  std::array<char, 96> line{};
  std::snprintf(line.data(), line.size(),
                "HETATM%5zu %-4s %3s A%4d    %8.3f%8.3f%8.3f  1.00  0.00          %2s\n",
                atom % 100000, name_of(element, atom).c_str(), residue, residue_number, position[0],
                position[1], position[2], element.c_str());
  text += line.data();
}

}  // namespace

void append_pdb(std::string& text, const Scene& scene, const Frame& frame,
                const std::string& hip_label, std::size_t number) {
  std::array<char, 32> model{};
  std::snprintf(model.data(), model.size(), "MODEL     %4zu\n", number % 10000);
  text += model.data();
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
