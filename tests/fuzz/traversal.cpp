// A random grid, judged and played: what the checks of verify call fine must play, by the rule that
// stays on a branch and with the forces of the interpolated energy, without a link that is missing,
// without a jump of the state but at a snap, and without energy for the hand. A grid that they do
// not call fine is played as well, if play takes it: then only the safety core's promises hold.
//
// Made of the input: the box's counts, the levels of each point, and for each record a state, an
// energy, a force and links. The first byte says whether the levels are branches
// with an energy each, of which some snap to others, or noise.
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "libcore/check/invariants.hpp"
#include "libcore/check/passive.hpp"
#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/node_force.hpp"
#include "libcore/loop/safety.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/unit/check/tiny_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::fuzz;

namespace {

/// Numbers from an input; zeros behind its end.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  unsigned below(unsigned n) { return byte() % n; }
  /// In [-1, 1).
  double number() { return byte() / 128.0 - 1; }

 private:
  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t first = rest_.front();
    rest_ = rest_.subspan(1);
    return first;
  }

  std::span<const std::uint8_t> rest_;
};

void require(bool holds, const char* what) {
  if (holds) return;
  std::cerr << "finding: " << what << std::endl;
  std::abort();
}

/// An energy in newtons times spacings: base + slope x + 1/2 curvature x^2 on each axis.
struct Branch {
  double base;
  Vec3 slope, curvature;

  double energy(const Vec3& x) const {
    double e = base;
    for (int a = 0; a < 3; ++a) e += x[a] * (slope[a] + x[a] * curvature[a] / 2);
    return e;
  }
  Vec3 force(const Vec3& x) const {
    Vec3 f;
    for (int a = 0; a < 3; ++a) f[a] = -(slope[a] + x[a] * curvature[a]);
    return f;
  }
};

struct Case {
  std::unique_ptr<Grid> grid;
  RecordFields fields;
};

constexpr unsigned kMostLevels = 3;

Case make_case(Input& input) {
  const bool noise = input.below(4) == 0;
  const auto count = [&] { return 1 + input.below(4); };
  const Box box{{0, 0, 0}, 1, {1 + count(), count(), count()}};
  std::array<Branch, kMostLevels> branches;
  for (Branch& b : branches) {
    b.base = input.number();
    for (int a = 0; a < 3; ++a) b.slope[a] = input.number();
    for (int a = 0; a < 3; ++a) b.curvature[a] = input.number();
  }
  std::vector<unsigned> levels(box.points());
  for (unsigned& n : levels) n = 1 + input.below(kMostLevels);
  const Neighbourhood around(box);
  RecordColumns columns;
  Case made;
  for (PointIndex p = 0; p < box.points(); ++p)
    for (unsigned level = 0; level < levels[p]; ++level) {
      columns.point.push_back(p);
      columns.level.push_back(static_cast<Level>(level));
      columns.generation.push_back(0);
      const Vec3 x = box.position(p);
      const Branch& branch = branches[level];
      // A state in [-1, 1); a branch's changes slowly, so that branches are told from each other.
      columns.rows.push_back(noise ? input.number()
                                   : 0.6 * level - 0.7 + 0.02 * (x[0] + x[1] + x[2]));
      made.fields.energy.push_back(noise ? input.number() : branch.energy(x));
      made.fields.force.push_back(
          noise ? Vec3{3 * input.number(), 3 * input.number(), 3 * input.number()}
                : branch.force(x));
      for (int q = 0; q < kDirections; ++q) {
        if (!(around.inside(p) >> q & 1)) {
          columns.links.push_back(kLeavesBox);
          continue;
        }
        const unsigned there = levels[static_cast<std::size_t>(p + around.offset(q))];
        // A branch goes on where it can, and where it cannot it snaps to the lowest one.
        const unsigned to = noise ? input.below(there + (input.below(16) == 0))
                                  : (level < there ? level : input.below(there));
        columns.links.push_back(static_cast<Level>(to));
      }
    }
  GridSpec spec;
  spec.box = box;
  spec.state_size = 1;
  made.grid = std::make_unique<Grid>(spec, 1, std::move(columns));
  return made;
}

/// The hand: straight legs at 6 mm/s an axis or less, in ticks of a millisecond, on 6 mm a spacing.
constexpr int kLegs = 4, kTicks = 600;
constexpr double kStep = 1e-3;     // spacings a tick and axis
constexpr double kMetres = 0.006;  // a spacing
// States are in [-1, 1] and ghosts in [-7, 7], so the blend moves by 3 x 14 steps at most; an
// offset of 70, from five changes of all corners within half a spacing, fades by 70 x 2 x sqrt(3)
// steps (tests/unit/follow/branch_test.cpp).
constexpr double kMostMoved = (3 * 14 + 70 * 2 * 1.7321) * kStep;

void play(const Case& made, bool is_fine, Input& input) {
  const Grid& grid = *made.grid;
  const auto map = std::make_shared<const BranchNodes>(grid);
  const auto nodes =
      std::make_shared<const NodeEnergies>(node_energies(grid, made.fields, map.get()));
  BranchTraversal traversal(grid, map);
  NodeForce force(nodes, grid.box(), hermite_force);
  SafetyLimits limits;
  limits.ramp_ms = 0;
  limits.encoder = 0;
  SafetyCore core(limits);
  core.begin();
  Vec3 x, sent{0, 0, 0};
  for (int a = 0; a < 3; ++a) x[a] = (input.number() + 1) / 2 * (grid.box().counts[a] - 1);
  double returned = 0;
  double before = 0;
  bool was_usable = false;
  Vec3 step{0, 0, 0};
  for (int tick = 0; tick <= kLegs * kTicks; ++tick) {
    if (tick % kTicks == 0)
      for (double& s : step) s = kStep * input.number();
    for (int a = 0; a < 3; ++a) {
      x[a] += step[a];
      returned += sent[a] * step[a] * kMetres;
    }
    const StepResult result = tick == 0 ? traversal.start(x) : traversal.step(x);
    if (is_fine) require(result.usable(), "a link is missing");
    require(std::isfinite(traversal.state()[0]), "a state is not finite");
    // Behind a link that is missing the hand goes on alone.
    const bool follows = tick > 0 && was_usable && result.usable() && !result.snapped;
    require(!follows || std::abs(traversal.state()[0] - before) <= kMostMoved,
            "a jump without a snap");
    was_usable = result.usable();
    before = traversal.state()[0];
    SafetyInput wanted;
    wanted.unusable = !result.usable();
    if (result.usable()) wanted.force = force(traversal);
    wanted.place = Vec3{x[0] * kMetres, x[1] * kMetres, x[2] * kMetres};
    sent = core.apply(wanted).force;
    require(returned <= limits.reserve * 1e-3 + kTankSlack + 1e-12, "energy is returned");
  }
}

/// The checks of verify that need no model.
bool is_fine_grid(const Case& made) {
  const Grid& grid = *made.grid;
  const tiny::TestModel model(grid.spec(), nullptr);
  const BranchNodes map(grid);
  const NodeEnergies nodes = node_energies(grid, made.fields, &map);
  return is_fine({check_coverage(grid), check_links(grid), check_finite(grid),
                  check_distinct(grid, model), check_continuous(grid, map),
                  check_passive(grid, map, nodes)});
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4) return 0;
  Input input(data, size);
  refusable([&] {
    const Case made = make_case(input);
    play(made, is_fine_grid(made), input);
  });
  return 0;
}
