// What play does off the grid's points, against what the model does there.
//
// A random hand walks through the box. Play follows it (follow/traversal.hpp), and so does the
// model, from the same state, by C in steps that are small against the spacing. After some steps
// the two are compared. They differ for two reasons:
// - Play interpolates. This error falls with the spacing.
// - A branch ends. The model changes its branch at one place. By the paper's rule play changes it
//   corner by corner at the faces of nearby cells, and blends the branches in between: this error
//   is the distance of the branches, whatever the spacing; only the region where it occurs shrinks.
//   By the rule that stays on a branch (follow/branch_traversal.hpp) some corners are extrapolated
//   there.
// The model itself says which reason applies: C from each corner of the cell, with the record that
// play has there, must lead to the state of the model that walked, and C from there back to the
// record. Where that holds for all corners, there is one branch, and the error is the
// interpolation's. Where it holds for none, play and model have parted, and both go on from the
// nearest corner with play's record. Else a branch ends in the cell.
//
// Places where all corners and the model are in one state are called empty and counted apart:
// otherwise a larger box would look more accurate.
//
// The state of the same place is interpolated again from every other point of the grid, as in a
// grid of twice the spacing. This tells how the error falls with the spacing (accuracy.hpp).
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcore/base/random.hpp"
#include "libcore/check/fidelity.hpp"
#include "libcore/check/report.hpp"
#include "libcore/follow/traversal.hpp"
#include "libcore/grid/box.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/fields.hpp"

namespace hapgrid {

// A hand that moves at random: it goes straight for a while, turns, and is reflected at the sides
// of the box.

class RandomHand {
 public:
  /// @param box outlives the hand. @param steps that it makes in a leg, from one place to the next:
  /// half a spacing or less.
  RandomHand(const Box& box, std::uint64_t seed, int steps)
      : box_(box), random_(seed), steps_(steps) {}

  /// To any point of the grid.
  PointIndex jump();
  const Vec3& at() const { return at_; }
  void put(const Vec3& x) { at_ = x; }
  /// Before each leg: may turn.
  void set_out();
  void step();

 private:
  void turn();

  const Box& box_;
  SplitMix64 random_;
  int steps_;
  Vec3 at_{0, 0, 0};
  Vec3 towards_{0, 0, 0};
  double length_ = 0;       // of a step
  std::uint64_t left_ = 0;  // legs before it turns
};

/// The number of places in a walk. They are at most half a spacing apart; the hand turns after some
/// of them.
inline constexpr int kPlacesInWalk = 32;
/// The number of steps from place to place, each at most an eighth of the spacing.
inline constexpr int kStepsToPlace = 4;

/// The error of play at a place in one branch where something changes: of the state in the unit of
/// the tolerance (state_distance.hpp), of the force in newtons.
struct PlayError {
  double state = 0;
  double force = 0;  ///< 0 where there is none
  /// The first one with twice the spacing; NaN where the branch does not have all points for it.
  double coarse_state = 0;
};

struct Walked {
  std::uint64_t places = 0;
  std::uint64_t empty = 0;            ///< of these: all corners, and the model, in one state
  std::uint64_t mixed = 0;            ///< of these: a branch ends in the cell
  std::uint64_t parted = 0;           ///< of these: play and the model are in different branches
  std::vector<PlayError> one_branch;  ///< all others, in the order of the walks
  /// The largest errors, each with the place where it was found first: in one branch, and of the
  /// state where a branch ends. They have neither name nor unit.
  Figure state, force, mixed_state;
  Findings failed;  ///< counts conversions; offenders are those that failed

  void add(Walked&& later);
};

/// @param walks how many. Each depends only on its own number and on `seed`.
/// @param make_model, make_traversal are called once for each thread, by the calling thread. The
/// traversal is of the rule that play follows.
/// @param walks_done counts the walks that are done.
Walked walk_grid(const Grid& grid, std::uint64_t walks, std::uint64_t seed,
                 const MakeModel& make_model,
                 const std::function<std::unique_ptr<Traversal>()>& make_traversal, int threads,
                 std::atomic<std::uint64_t>& walks_done);

}  // namespace hapgrid
