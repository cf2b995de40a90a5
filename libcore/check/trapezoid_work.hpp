// The work along links where nobody knows the force between the points: play evaluates the model's
// force at an interpolated state there (play --force state).
//
// The work is the trapezoid rule's, and each link has a bound of what the rule may be off by:
//
//   there and back on one branch  half of the larger one of the second differences of F · d at the
//                                 link's two ends. The error is a twelfth of it where F is smooth,
//                                 and at most a quarter with one kink in the link (contact begins).
//                                 At the end of a branch or of the box only one of the two is
//                                 known: then the bound is all of it, and half of the change of
//                                 F · d along the link. With none known, it is half of |F · d| at
//                                 both ends.
//   one way                       the state jumps somewhere on the link: half of the jump of F · d,
//                                 and half of its change over the links before and after.
//
// A link can hold more than one kink or jump where the spacing barely resolves the field, so four
// times the bound is allowed (the hung ball at h = r/2 needs 0.9 of it, alanine dipeptide at 30
// points a side 3 to 4; a force of the wrong sign is found there with 8).
#pragma once

#include "libcore/check/forces.hpp"
#include "libcore/check/work.hpp"

namespace hapgrid {

class TrapezoidWork final : public Work {
 public:
  /// Both must outlive this.
  TrapezoidWork(const Grid& grid, const Forces& forces) : Work(grid), forces_(forces) {}

  bool takes(int) const override { return true; }
  double gain(const Link& link) const override;
  double allowance(const Link& link) const override { return 4 * bound(link); }
  /// What the gain is off by, where the spacing resolves the field.
  double bound(const Link& link) const;

 private:
  const Forces& forces_;
};

}  // namespace hapgrid
