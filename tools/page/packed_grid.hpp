// A grid as a page carries it, to play it by itself: what play needs of it, in columns that deflate
// well. pack.hpp makes it, and player.cpp reads it in the page.
//
// A head, the spheres, the torsions, and then columns of whole numbers: of each number what is more
// than the one before it in its column, with the sign as its lowest bit; of all these the lowest
// bytes, then the next ones, and so on. In most of a box a model is at rest, and there all of them
// are zeros. Numbers are little-endian.
//
// The states are left out, since neither branches nor snaps nor forces look at them. The rows of
// the unpacked grid are what is seen instead: the model's own energy, where it has one, as a state
// of one number, and the places of the spheres that move. The player interpolates them as play
// interpolates states.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "libcore/follow/record_fields.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

struct PackedHead {
  char length_unit[16];
  double origin[3];
  double spacing;
  double shape_low;      ///< of the coordinates of spheres that move,
  double shape_step;     ///< which are whole numbers of these steps above it
  double hip_radius;     ///< as Scene has it
  double largest_force;  ///< alike
  std::uint32_t counts[3];
  std::uint32_t records;
  std::uint32_t spheres;
  std::uint32_t torsions;
  std::uint32_t by_energy;  ///< the force is the gradient of the energy; else the records' mean
  std::uint32_t has_own;    ///< the model has an energy of its own
};
struct PackedSphere {
  char label[8];
  float radius;
  float centre[3];  ///< where it does not move
  std::uint32_t moves;
};
// Then the four spheres of each torsion (4 bytes each), and the columns: by point the number of its
// levels (1 byte); by record the destination of each of the 26 directions (1 each),
// the energy above the lowest in newtons times the spacing (float), the force along x, y
// and z (float), the model's own energy in its unit, if it has one (float), and x y z of each
// sphere that moves (2).

/// As much of a text as there is room for, up to a NUL.
template <std::size_t N>
void write_text(const std::string& text, char (&room)[N]) {
  text.copy(room, N - 1);
}
template <std::size_t N>
std::string text_of(const char (&room)[N]) {
  return {room, std::find(room, room + N - 1, '\0')};
}

struct UnpackedGrid {
  Grid grid;
  RecordFields fields;
  bool by_energy;
  Scene scene;                       ///< what the shapes of a picture depend on, without texts
  std::vector<float> centres;        ///< x y z by sphere, of those that do not move
  std::vector<std::uint32_t> moved;  ///< the coordinates of `centres` that a row has, ascending
};

/// @param bytes what pack_grid() made. @throw FormatError when the records are not a grid's
UnpackedGrid unpack_grid(const unsigned char* bytes);

}  // namespace hapgrid
