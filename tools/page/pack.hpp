// Packs a grid for a page that plays it by itself (packed_grid.hpp).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libcore/model/model.hpp"
#include "libcore/scene/scene.hpp"
#include "libcore/shard/reader.hpp"

namespace hapgrid {

struct PackedGrid {
  std::string bytes;
  Scene scene;  ///< as play describes it
  Frame first;  ///< of the play that begins where the hand begins
  /// The lowest energy, in newtons times the unit of length; nothing where the force does not come
  /// from the energy, which is then not shown.
  std::optional<double> lowest;
  double force_scale = 0;  ///< as Fields has it
  bool snaps = false;      ///< a place has several levels
  /// By torsion, at -180, -175, ... 175 degrees: the lowest own energy of states between neighbours
  /// on a branch, which have this angle, so that barriers do not depend on where records lie; the
  /// lowest of all records at the nearest angle; NaN where there is none.
  std::vector<std::array<double, 72>> profiles;
};

/// The most that a page takes of the browser's memory for the spheres of all records, in bytes.
inline constexpr double kMostShapeBytes = 256e6;

/// @param name of the grid, for messages. @param create makes its model, which gives what the grid
/// does not store. @param near towards the viewer, on whose side the hand begins
/// @throw Error when the grid cannot be played, or its spheres need too much memory; ModelError
PackedGrid pack_grid(const Grid& grid, const std::string& name, const MakeModel& create,
                     const Vec3& near);

/// The spacing, in the model's unit, at which a grid of the same box needs a part of the bytes that
/// this one needs.
std::string spacing_for(const GridSpec& spec, double part);

}  // namespace hapgrid
