// Frames as a trajectory in the PDB format, which programs for molecules read with the elements.
#pragma once

#include <string>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// Appends one frame as MODEL `number` (from 1): a REMARK with what append_xyz() has in its
/// comment, and a HETATM an atom, residue MOL 1, its name the element and its number. With a
/// `hip_label` the HIP, held in the box, is an atom of residue HIP 2 at the end. Coordinates are in
/// the model's unit of length, which PDB takes for angstrom, with three decimals. Source: wwPDB,
/// Atomic Coordinate Entry Format 3.3.
/// @throw Error when a coordinate is not finite or too large for its eight columns.
void append_pdb(std::string& text, const Scene& scene, const Frame& frame,
                const std::string& hip_label, std::size_t number);

}  // namespace hapgrid
