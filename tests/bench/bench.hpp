// What the benchmarks of traversals share: the model of a grid, figures, and main().
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "libcore/follow/traversal.hpp"
#include "libcore/model/plugin_model.hpp"
#include "libcore/shard/reader.hpp"

namespace hapgrid::bench {

/// @param models the directory of the plug-ins
inline MakeModel model_of(const Grid& grid, std::string models) {
  return [&grid, models] {
    return Plugin(grid.spec().model, {models}).create(grid.spec().parameters);
  };
}

inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

inline double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

inline double quantile(std::vector<double>& values, double q) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

inline StepResult go(Traversal& traversal, const std::vector<Vec3>& path, std::size_t i) {
  return i == 0 ? traversal.start(path[i]) : traversal.step(path[i]);
}

/// @param run (grid, argc, argv), whose result is the exit code; argv[1] names the grid.
template <typename Run>
int main_of(int argc, char** argv, int least, const char* usage, const Run& run) {
  if (argc < least) return std::fprintf(stderr, "%s\n", usage), 2;
  try {
    return run(load_grid(argv[1]), argc, argv);
  } catch (const std::exception& e) {
    return std::fprintf(stderr, "%s: %s\n", argv[0], e.what()), 1;
  }
}

}  // namespace hapgrid::bench
