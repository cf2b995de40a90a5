#include "libcore/check/steep.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "libcore/base/text.hpp"
#include "libcore/check/paths.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

/// The largest of some numbers, and where the first of them is.
struct LargestSlope {
  double value = 0;
  Configuration where;
  CornerPair edge{};

  void look_at(double other, const Configuration& configuration, const CornerPair& pair) {
    if (!(other > value)) return;
    value = other;
    where = configuration;
    edge = pair;
  }
  void add(const LargestSlope& later) { look_at(later.value, later.where, later.edge); }
};

struct Steepest {
  Findings found;
  LargestSlope state, force, force_in_branch, stiffness;

  void add(Steepest&& later) {
    found.add(std::move(later.found));
    state.add(later.state);
    force.add(later.force);
    force_in_branch.add(later.force_in_branch);
    stiffness.add(later.stiffness);
  }
};

double norm(const Vec3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
double length(const Vec3& a, const Vec3& b) {
  return norm({a[0] - b[0], a[1] - b[1], a[2] - b[2]});
}

class SlopeSurvey {
 public:
  SlopeSurvey(const Grid& grid, const Forces* forces, const Rendering& rendering)
      : grid_(grid),
        cells_(grid),
        forces_(forces),
        rendering_(rendering),
        pairs_(corner_pairs(cells_)) {
    for (const CornerPair& pair : pairs_) {
      const auto step = Direction(pair.q).step();
      if (pair.a < pair.b && std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]) == 1)
        edges_.push_back(pair);
    }
  }

  void look_at(const Configuration& configuration, bool can_be_mixed, Steepest& seen) const {
    ++seen.found.counted;
    const Corners corners = corners_of(grid_, cells_, configuration);
    const double h = grid_.box().spacing;
    Vec3 along{0, 0, 0};  // the largest |ΔF| / h of each axis
    CornerPair steepest{};
    for (const CornerPair& edge : edges_) {
      const RecordIndex a = corners.record[edge.a], b = corners.record[edge.b];
      seen.state.look_at(distance(grid_.spec().equality, grid_.state_size(), grid_.state(a).data(),
                                  grid_.state(b).data()) /
                             h,
                         configuration, edge);
      if (!forces_) continue;
      const double slope = length((*forces_)[a], (*forces_)[b]) / h;
      double& axis = along[axis_of(edge)];
      if (slope > std::max({along[0], along[1], along[2]})) steepest = edge;
      axis = std::max(axis, slope);
    }
    if (!forces_) return;
    const double largest = std::max({along[0], along[1], along[2]});
    seen.force.look_at(largest, configuration, steepest);
    if (largest > seen.force_in_branch.value && !(can_be_mixed && is_mixed(grid_, pairs_, corners)))
      seen.force_in_branch.look_at(largest, configuration, steepest);
    const double stiffness = norm(along);
    seen.stiffness.look_at(stiffness, configuration, steepest);
    if (rendering_.scale && !(stiffness * *rendering_.scale < rendering_.limit()))
      seen.found.offend({configuration.base, {}, {}}, [&] {
        return describe(grid_, configuration) + ": " + rounded(stiffness * *rendering_.scale) +
               " N/m";
      });
  }

  std::string describe_edge(const LargestSlope& l) const {
    return "from " + describe(grid_.box(), cells_.point(l.where.base, l.edge.a)) + " to " +
           describe(grid_.box(), cells_.point(l.where.base, l.edge.b)) + ", in " +
           describe(grid_, l.where);
  }

 private:
  static int axis_of(const CornerPair& edge) {
    const int bit = edge.a ^ edge.b;
    return bit == 1 ? 0 : bit == 2 ? 1 : 2;
  }

  const Grid& grid_;
  const Cells cells_;
  const Forces* forces_;
  const Rendering rendering_;
  const std::vector<CornerPair> pairs_;
  std::vector<CornerPair> edges_;  // once each
};

}  // namespace

Check check_steep(const Grid& grid, const CellMap& map, const Configurations& found,
                  const Forces* forces, const Rendering& rendering, int threads) {
  const SlopeSurvey survey(grid, forces, rendering);
  const auto simple = [&](PointIndex base, Steepest& seen) {
    if (map.exists(base) && map.is_simple(base)) survey.look_at({base, 0}, false, seen);
  };
  const auto listed = [&](const Configuration& c, Steepest& seen) {
    survey.look_at(c, true, seen);
  };
  Steepest seen = look_at_all<Steepest>(grid, found, threads, simple, listed);

  const GridSpec& spec = grid.spec();
  const std::string a_length =
      "/" + (spec.length_unit.empty() ? std::string("length") : spec.length_unit);
  Check check{"steep", "configurations",
              "configurations that are stiffer than the device renders stably",
              std::move(seen.found), true};
  const auto add = [&](const std::string& name, const std::string& unit,
                       const LargestSlope& largest) {
    check.figures.push_back({name, largest.value, unit + a_length,
                             largest.value > 0 ? survey.describe_edge(largest) : ""});
  };
  add("state", distance_unit(spec), seen.state);
  if (!forces) return check;
  add("force", "N", seen.force);
  add("force in one branch", "N", seen.force_in_branch);
  const std::string device = "K < 2 b f = " + rounded(rendering.limit()) +
                             " N/m with b = " + rounded(rendering.damping) +
                             " N s/m and f = " + rounded(rendering.rate_hz) + " Hz";
  if (rendering.scale) {
    const double stiffness = seen.stiffness.value * *rendering.scale;
    check.figures.push_back(
        {"stiffness", stiffness, "N/m",
         (stiffness < rendering.limit() ? "stable: " : "not stable: ") + device});
  } else if (seen.stiffness.value > 0) {
    check.figures.push_back({"largest stable scale", rendering.limit() / seen.stiffness.value,
                             (spec.length_unit.empty() ? "lengths" : spec.length_unit) + "/m",
                             device});
  }
  return check;
}

}  // namespace hapgrid
