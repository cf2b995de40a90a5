// Frames as a trajectory in the formats XYZ and PDB, which programs for molecules read.
#pragma once

#include <cstddef>
#include <string>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// Appends one frame in XYZ: the number of atoms; a comment "time=... tick=... hip=x,y,z
/// force=fx,fy,fz energy=... units=..." (energy only if the model has one) in SI units and the
/// model's, which it names; and a line "symbol x y z" for each atom. Coordinates are in the model's
/// unit of length, which XYZ takes for angstrom, with six decimals.
///
/// The symbol of an atom is its sphere's label, or X if the label is no symbol (is_symbol()). With
/// a `hip_label` the HIP, held in the box, is the last atom.
/// @throw Error when a coordinate is not finite.
void append_xyz(std::string& text, const Scene& scene, const Frame& frame,
                const std::string& hip_label);

/// Appends one frame in PDB, as MODEL `number` (from 1): a REMARK with the comment of append_xyz(),
/// and a HETATM for each atom, in residue MOL 1; an atom's name is its element and its number. With
/// a `hip_label` the HIP, held in the box, is the last atom, in residue HIP 2. Coordinates are in
/// the model's unit of length, which PDB takes for angstrom, with three decimals. Source: wwPDB,
/// Atomic Coordinate Entry Format 3.3.
/// @throw Error when a coordinate is not finite, or too large for its eight columns.
void append_pdb(std::string& text, const Scene& scene, const Frame& frame,
                const std::string& hip_label, std::size_t number);

/// Appends the bonds of a frame's spheres (find_bonds()) for the end of a PDB file, where they hold
/// for all its models: a CONECT for each atom that has some, or several where these are more than
/// four.
void append_pdb_bonds(std::string& text, const Scene& scene, const Frame& frame);

/// Whether XYZ can have this as an atom's symbol: a letter, then letters or digits.
bool is_symbol(const std::string& label);

}  // namespace hapgrid
