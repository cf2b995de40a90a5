// Frames as a trajectory in the XYZ format, which programs for molecules read.
#pragma once

#include <string>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// Appends one frame: the number of atoms; a comment "time=... tick=... hip=x,y,z force=fx,fy,fz
/// energy=..." (energy only if the model has one) with SI units and the model's; a line
/// "symbol x y z" an atom. Coordinates are in the model's unit of length, which XYZ takes for
/// angstrom, with six decimals.
///
/// A symbol is the sphere's label, or X where it has none that a symbol can be (a letter, then
/// letters or digits). With a `hip_label` the HIP, held in the box, is an atom at the end.
/// @throw Error when a coordinate is not finite.
void append_xyz(std::string& text, const Scene& scene, const Frame& frame,
                const std::string& hip_label);

/// The comment of a frame, without an end of line.
std::string frame_comment(const Frame& frame);

/// Whether XYZ can have this as an atom's symbol.
bool is_symbol(const std::string& label);

}  // namespace hapgrid
