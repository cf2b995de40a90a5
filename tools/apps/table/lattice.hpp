// The file of a table, as `hapgrid table` writes it: energies on a lattice, which
// may be sheared, and atoms for pictures. It is a text:
//
//   hapgrid-table
//   counts 41 41 41
//   origin -7.5 -7.5 -7.5          of the first point; lengths in the definition's length_unit
//   axis 0.375 0 0                 from a point to the next one along the first axis,
//   axis 0 0.375 0                 the second,
//   axis 0 0 0.375                 and the third
//   atom C 1.2 0.4 -0.3            any number of them
//   values                         the first axis fastest; nan where there is no value
//   -0.12 -0.13 ...
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tools/apps/table/spline.hpp"

namespace hapgrid::table {

using Vector = std::array<double, 3>;

inline double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double length(const Vector& a) { return std::sqrt(dot(a, a)); }
inline Vector minus(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct Atom {
  std::string label;  ///< the symbol of the element
  Vector position;
};

struct Lattice {
  Spline::Counts counts{};
  Vector origin{};
  std::array<Vector, 3> axes{};
  std::array<Vector, 3>
      inverse{};  ///< rows: lattice coordinate a of x is inverse[a] · (x − origin)
  std::vector<Atom> atoms;
  std::vector<double> values;  ///< NaN where there is none

  /// Lattice coordinates of a place.
  Vector coordinates(const double* x) const;
  /// Where a point of the lattice is, by its three numbers.
  Vector place(const Spline::Counts& point) const;
  /// The gradient by the place, from that by lattice coordinates.
  Vector gradient(const Vector& by_lattice) const;
};

/// The most values of a table; more would not fit into [model.files] either.
inline constexpr std::size_t kMaxValues = 16u << 20;

/// @throw std::runtime_error with one line, in which the file is called `name`.
Lattice read_lattice(const std::string& text, const std::string& name);

/// The colour and radius (angstrom) with which an element is drawn.
void look_of(const std::string& element, float& radius, float colour[3]);

}  // namespace hapgrid::table
