#include "libcore/check/steep.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

// What devices have, and the rate of play by default.
constexpr double kDamping = 2, kRateHz = 1000;               // N s/m, Hz
constexpr double kStableStiffness = 2 * kDamping * kRateHz;  // K, N/m

Check check_steep(const Grid& grid, std::span<const Vec3> forces) {
  const GridSpec& spec = grid.spec();
  const double h = grid.box().spacing;
  const std::string a_length = "/" + (spec.length_unit.empty() ? "length" : spec.length_unit);
  Check check{"steep",
              "records",
              "how steep state and force are on a branch, and where a device renders that stably",
              {},
              /*is_note=*/true};
  check.found.counted = grid.records();
  Figure state{"state", 0, distance_unit(spec) + a_length, ""};
  Figure force{"force", 0, "N" + a_length, ""};
  const auto keep_larger = [&](Figure& largest, double slope, RecordIndex r, int q) {
    if (!(slope > largest.value)) return;
    largest.value = slope;
    largest.where = "along " + describe_link(grid, r, q);
  };
  double stiffness = 0;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    double squares = 0;
    for (int axis = 0; axis < 3; ++axis) {
      double larger = 0;
      for (const int sign : {-1, 1}) {
        std::array<int, 3> step{0, 0, 0};
        step[axis] = sign;
        const int q = Direction::of(step[0], step[1], step[2]).q();
        const RecordIndex to = grid.destination(r, q);
        if (to == Grid::kNoRecord || grid.is_one_way(r, q)) continue;
        keep_larger(state,
                    distance(spec.equality, grid.state_size(), grid.state(r).data(),
                             grid.state(to).data()) /
                        h,
                    r, q);
        if (forces.empty()) continue;
        const Vec3 &f = forces[r], &g = forces[to];
        const double slope = std::hypot(f[0] - g[0], f[1] - g[1], f[2] - g[2]) / h;
        keep_larger(force, slope, r, q);
        larger = std::max(larger, slope);
      }
      squares += larger * larger;
    }
    stiffness = std::max(stiffness, std::sqrt(squares));
  }
  check.figures = {state};
  if (forces.empty()) return check;
  check.figures.push_back(force);
  if (!(stiffness > 0)) return check;
  const Vec3 side = grid.box().high() - grid.box().origin;
  const double longest = std::max({side[0], side[1], side[2]});
  check.figures.push_back({"largest stable scale", kStableStiffness / stiffness,
                           (spec.length_unit.empty() ? "lengths" : spec.length_unit) + "/m",
                           format("K < 2 b f = {} N/m with b = {} N s/m and f = {} Hz",
                                  kStableStiffness, kDamping, kRateHz)});
  check.figures.push_back({"shortest stable reach", longest * stiffness / kStableStiffness, "m",
                           "of a device whose reach fills the box, as by default"});
  return check;
}

}  // namespace hapgrid
