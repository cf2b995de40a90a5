// A rule of traversal that stays on a branch until the model snaps off it.
//
// The paper's rule (paper_traversal.hpp) gives each corner of a cell a level of its own. Where
// branches end the corners then belong to several of them, and the state is a blend that the model
// never takes. Here one record of the cell, the *anchor*, says which branch the hand is on, and the
// other corners are that branch's (branch_nodes.hpp). A branch that ends inside the cell has ghosts
// in the corners behind its end. It ends where these weigh more than the other corners in the
// interpolation, which is in the middle of a one-way link. When the hand comes there the state
// snaps, to where the links lead.
//
// In a *mixed* cell the records contradict each other: there the branches meet, finer than the
// grid. Of the records that keep what the cell shares with the one before, that one is the anchor
// whose corners contradict each other least where the HIP is.
//
// The state jumps where it snaps and nowhere else, whatever the links are. With the same corners it
// is continuous, because it is interpolated. When the corners change otherwise, because a new cell
// has another anchor, the difference at the place of the change becomes an *offset*: the state goes
// on from where it was, and the offset fades while the hand moves on, by half a spacing.
//
// All this is a guess where branches end or meet, and between grid points a state is interpolated.
// A model that walks beside the grid (beside.hpp) knows better. Its answers belong to places where
// the hand was, or will be, so the grid says how the state changes between them: the state is that
// of the branch of the cell which is nearest to the model's, and what this branch lacked at the
// place of an answer is added. Of the last 16 answers we use the one whose place is nearest to the
// hand: a hand that turns round never reaches the place that the newest answer looked ahead to.
// There and back are then the same to the hand, whichever branch of the grid is taken. When no
// answer comes, what was added fades like any offset, and the grid decides.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "libcore/follow/branch_nodes.hpp"
#include "libcore/follow/traversal.hpp"

namespace hapgrid {

class BranchTraversal final : public Traversal {
 public:
  /// @param branches of the same grid. @throw Error as CellWalk does
  BranchTraversal(const Grid& grid, std::shared_ptr<const BranchNodes> branches,
                  std::uint16_t most_parts = CellWalk::kDefaultMaxParts);
  using Traversal::start;
  using Traversal::step;
  const StepResult& start(const Vec3& hip, Level level) noexcept override;
  const StepResult& step(const Vec3& hip, bool next) noexcept override;
  void walk_beside(Beside* beside) override { beside_ = beside; }
  const BesideAnswer* followed() const override { return followed_; }
  bool follows_as_before() const override { return follows_as_before_; }
  const BranchNodes* branch_nodes() const override { return branches_.get(); }

 private:
  /// The corners that an anchor gives a cell.
  struct Branch {
    int anchor = 0;
    std::array<Node, 8> nodes{};
    bool is_torn = false;                 // a corner is a ghost
    bool is_mixed = false;                // other corners are not of one branch themselves
    std::array<std::uint8_t, 8> apart{};  // and which: BranchNodes::apart()
  };
  bool take(int nearest, Level level, bool chosen) noexcept;
  bool cross(const CellWalk::Part& way) noexcept;
  void arrive() noexcept;
  void note_snap() noexcept { step_.snapped = step_.level_changed = true; }
  void evaluate() noexcept;
  bool derive(PointIndex base, RecordIndex anchor, int corner, Branch& branch) const noexcept;
  void enter_branch(const Branch& branch) noexcept;
  bool cross_on_one_branch(const CellWalk::Part& way, int beside, const CellSwitch& move) noexcept;
  bool cross_by_snap(PointIndex base, int to, const CellSwitch& move) noexcept;
  int common_record(const CellSwitch& move, const Vec3& part) const noexcept;
  bool decide_by_grid() noexcept;
  bool snap(const Vec3& part) noexcept;
  bool find_better(PointIndex base, const std::array<double, 8>& weights,
                   const std::array<RecordIndex, 8>& kept, Branch& branch) const noexcept;
  void change_anchor() noexcept;
  // With a model beside the grid (branch_beside.cpp).
  void follow_model() noexcept;
  void follow_newest() noexcept;
  void follow_grid() noexcept;
  void pass_over_older() noexcept;
  void tell_model() noexcept;
  const BesideAnswer& keep_nearest(const BesideAnswer& newest) noexcept;
  void follow(const BesideAnswer& answer) noexcept;
  double find_missing(const std::array<const double*, 8>& rows,
                      const std::array<double, 8>& weights, std::span<const double> row,
                      std::span<double> missing) noexcept;
  double length2(std::span<const double> difference) const noexcept;
  void enter_nearest(const std::array<double, 8>& weights, std::span<const double> row,
                     double least) noexcept;
  void find_candidates() noexcept;
  bool has_ended(const std::array<Node, 8>& nodes,
                 const std::array<double, 8>& weights) const noexcept;
  void keep_state(const std::array<const double*, 8>& before, const std::array<double, 8>& weights,
                  const std::array<const double*, 8>& after) noexcept;

  std::shared_ptr<const BranchNodes> branches_;
  int anchor_ = 0;  // the corner whose record names the branch
  std::array<const double*, 8> rows_{};
  Vec3 part_{0, 0, 0};               // of the cell, at position()
  std::array<double, 8> weights_{};  // there
  bool is_torn_ = false;             // a corner is a ghost
  bool is_mixed_ = false;  // corners are not of one branch, and which: BranchNodes::apart()
  std::array<std::uint8_t, 8> apart_{};
  FadingOffset offset_;  // of row()

  Beside* beside_ = nullptr;
  const BesideAnswer* followed_ = nullptr;  // by the last step
  bool follows_as_before_ = false;
  std::uint64_t held_tick_ = 0;  // of the last answer that was followed
  static constexpr std::size_t kKept = 16;
  std::array<BesideAnswer, kKept> kept_{};  // the last answers, a ring
  std::size_t last_kept_ = 0;
  std::uint64_t trusted_from_ = 0;  // an answer of an earlier Beside::tick() is passed over
  std::vector<double> missing_;     // see find_missing()
  std::vector<double> expected_;    // in follow(): the offset, less what is missing
  // How many branches of a cell are compared with the model's state.
  static constexpr std::size_t kMostCandidates = 64;
  std::vector<Branch> candidates_;  // all branches of the cell at candidates_base_, if any
  PointIndex candidates_base_ = 0;
};

}  // namespace hapgrid
