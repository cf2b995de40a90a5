// What play does off the grid's points, against what the model does there.
//
// A random hand walks through the box. Play follows it (haptic/traversal.hpp), and so does the
// model, from the same state, by C in steps that are small against the spacing. Every now and then
// the two are compared. They differ for two reasons, which have nothing to do with each other:
// - play interpolates, and the model is no polynomial: an error that falls with the spacing;
// - a branch ends. The model loses contact at one place; play does at the cell's faces, corner by
//   corner, anywhere in the same cell or those around, and between holds a blend. The difference is
//   the distance of the branches, whatever the spacing; only where it is found shrinks.
// So each place is told apart by the model itself: C from each corner of the cell, with the record
// that play has there, must lead to the state of the model that walked, and C from there back to
// the record. Where that holds of all corners, there is one branch, and the difference is the
// interpolation's. Where it holds of none, the two have parted, and go on from a common place: the
// nearest corner, with play's record there, so that play itself never jumps. Else play blends
// branches.
//
// Much of a box can be empty: wherever play and the model can be in the cell, they are in one
// state, and there is nothing to interpolate. These places are counted apart, or a larger box would
// be the more accurate one.
//
// For the same place the state is interpolated once more from every other point of the grid, which
// is a grid of twice the spacing: how the error falls with the spacing (accuracy.hpp).
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libcore/check/fidelity.hpp"
#include "libcore/check/range.hpp"
#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/fields.hpp"

namespace hapgrid {

/// The places of a walk, half a spacing apart or less; the hand turns after some of them.
inline constexpr int kPlacesInWalk = 32;
/// The steps from place to place in which play and the model follow: an eighth of the spacing or
/// less.
inline constexpr int kStepsToPlace = 4;

/// How far play is off in a place with one branch where something changes: the state in the unit of
/// the tolerance (state_distance.hpp), the force in newtons.
struct PlayError {
  double state = 0;
  double force = 0;  ///< 0 where there is none
  /// The same with twice the spacing; not a number where the branch has not all points for it.
  double coarse_state = 0;
  double coarse_force = 0;
};

/// A number, and where the first of its kind was.
struct WorstError {
  double value = 0;
  std::string where;
  void add(WorstError&& later) {
    if (later.value > value) *this = std::move(later);
  }
};

struct Walked {
  std::uint64_t places = 0;
  std::uint64_t empty = 0;            ///< of these: all corners, and the model, in one state
  std::uint64_t mixed = 0;            ///< of these: play blends branches
  std::uint64_t parted = 0;           ///< of these: play and the model are in different branches
  std::vector<PlayError> one_branch;  ///< all others, in the order of the walks
  WorstError state, force;            ///< in one branch
  WorstError mixed_state;
  Findings failed;  ///< conversions counted, and those that failed

  void add(Walked&& later);
};

/// What walks need of the grid's model. Each is called once a thread, from the calling thread.
struct WalkModels {
  std::function<ModelFunctions()> functions;
  std::function<SameState()> same;  ///< the tolerance function as it is
  std::function<Fields()> fields;   ///< for the force; empty: there is none
};

/// @param walks which of the walks: each is drawn by its own number and `seed` alone.
/// @param walks_done counts up meanwhile.
Walked walk_grid(const Grid& grid, const Range& walks, std::uint64_t seed, const WalkModels& models,
                 int threads, std::atomic<std::uint64_t>& walks_done);

}  // namespace hapgrid
