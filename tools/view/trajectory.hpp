// Frames as a trajectory in the format XYZ, which programs for molecules read.
#pragma once

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

/// Whether XYZ can have this as an atom's symbol: a letter, then letters or digits.
bool is_symbol(const std::string& label);

}  // namespace hapgrid
