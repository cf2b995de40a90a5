// Grids along a line, and models that differ from them.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <thread>

#include "libcore/follow/beside.hpp"
#include "libcore/follow/branch_traversal.hpp"
#include "libcore/model/model.hpp"
#include "tests/unit/check/tiny_grid.hpp"
#include "tests/unit/follow/random_grid.hpp"

namespace hapgrid::testing {

// Where the model's upper branch ends, before and behind the place where the grid says so, and
// where it comes back, before that place.
inline constexpr double kEndsEarly = 4.3, kEndsLate = 4.9, kComesBack = 2.6;

/// Along a line: 10 + x on the upper branch, -100 on the lower one.
inline double state_at(bool upper, double x) { return upper ? 10 + x : -100; }

/// Records at 0 1 2 3 4 on the upper branch, and at 3 4 5 6 7 on the lower one: in the order of
/// points, at each of them the upper branch first.
inline RecordColumns line_columns() {
  RecordColumns columns;
  for (int i = 0; i < 8; ++i)
    for (const bool upper : {true, false}) {
      if (upper ? i > 4 : i < 3) continue;
      const Level left = i == 0 ? kLeavesBox : !upper && i >= 4 && i <= 5;
      const Level right = i == 7 ? kLeavesBox : !upper && i < 4;
      tiny::add(columns, static_cast<PointIndex>(i), !upper && i <= 4, 0, state_at(upper, i), left,
                right);
    }
  return columns;
}

inline Box line_box() { return {{0, 0, 0}, 1, {8, 1, 1}}; }

/// The grid says that the upper branch ends at 4.5, the middle of a link, and comes back at 2.5.
inline Grid line() { return Grid(spec_for(line_box(), 1), 1, line_columns()); }

inline std::unique_ptr<Model> model_of_line(const GridSpec& spec, double ends, int pause_us = 0) {
  return std::make_unique<tiny::TestModel>(
      spec, [=](const double* s, const Vec3& x, const Vec3& d, double* row, std::string&) {
        if (pause_us > 0) std::this_thread::sleep_for(std::chrono::microseconds(pause_us));
        const double to = x[0] + d[0];
        *row = state_at(*s > 0 ? to <= ends : to < kComesBack, to);
        return true;
      });
}

// Between the points of a grid that stores forces, this model's state and force differ from what is
// interpolated.
inline constexpr double kWave = 0.05;

inline double wave(double x) { return kWave * std::sin(2 * std::numbers::pi * x); }

/// One branch: state and force along x are linear, but for the wave.
inline Grid straight_line() {
  GridSpec spec = spec_for(line_box(), 1);
  spec.tolerance = 4 * kWave;
  spec.stored.force = true;
  RecordColumns columns;
  for (int i = 0; i < 8; ++i) {
    tiny::add(columns, static_cast<PointIndex>(i), 0, 0, i, i == 0 ? kLeavesBox : 0,
              i == 7 ? kLeavesBox : 0);
    columns.rows.insert(columns.rows.end(), {-i / 10.0, 0, 0});
  }
  return Grid(spec, 1, columns);
}

/// It fails beyond a place.
inline std::unique_ptr<Model> wavy_model(const GridSpec& spec, double fails_at) {
  return std::make_unique<tiny::TestModel>(
      spec, [=](const double*, const Vec3& x, const Vec3& d, double* row, std::string& error) {
        const double to = x[0] + d[0];
        std::fill_n(row, 4, 0.0);
        row[0] = to + wave(to);
        row[1] = -to / 10 + wave(to);
        return to < fails_at || (error = "no", false);
      });
}

/// A traversal of a grid, and the model beside it.
struct WalkBeside {
  WalkBeside(const Grid& grid, std::unique_ptr<Model> model, std::optional<std::uint32_t> delay)
      : t(grid, std::make_shared<const BranchNodes>(grid)), beside(grid, std::move(model), delay) {
    beside.begin(1000);
    t.walk_beside(&beside);
  }
  BranchTraversal t;
  Beside beside;
};

}  // namespace hapgrid::testing
