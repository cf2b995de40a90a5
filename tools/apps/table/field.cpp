#include "tools/apps/table/field.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

namespace hapgrid::table {

namespace {

/// The lowest of the values that are there.
/// @throw std::runtime_error when one is missing and there is no wall, or none is below the wall.
double lowest(const std::vector<double>& values, const FieldOptions& options,
              const std::string& name) {
  double low = std::numeric_limits<double>::infinity();
  bool missing = false;
  for (const double value : values) {
    missing = missing || std::isnan(value);
    low = std::min(low, std::isnan(value) ? low : value);
  }
  if (missing && !options.has_wall)
    throw std::runtime_error(name +
                             ": values are missing: the parameter wall must say how high they are");
  if (options.has_wall && !(low < options.wall))
    throw std::runtime_error(name + ": no value is below the wall");
  return low;
}

}  // namespace

Field::Field(const Lattice& lattice, const FieldOptions& options, const std::string& name)
    : lattice_(lattice) {
  std::vector<double> values = std::exchange(lattice_.values, {});
  for (double& value : values) value *= options.factor;
  const double low = lowest(values, options, name);
  if (options.has_wall) {
    const double begin = (low + options.wall) / 2, room = options.wall - begin;
    for (double& value : values)
      if (!(value <= begin))
        value =
            std::isnan(value) ? options.wall : begin + room * -std::expm1(-(value - begin) / room);
  }
  const double high = *std::max_element(values.begin(), values.end());
  spline_ = Spline(lattice_.counts, values);
  find_steepest();
  if (!(high > low) || !(steepest_ > 0) || !std::isfinite(steepest_))
    throw std::runtime_error(name +
                             ": there is nothing to feel: the energy is the same everywhere");
  double most = 0;  // cells in a unit of length
  for (const Vector& row : lattice_.inverse) most = std::max(most, length(row));
  rise_ = 2 * steepest_ / most;
  find_minima(values);
}

double Field::at(const double* x, double* gradient) const {
  const Vector u = lattice_.coordinates(x);
  Vector outside{};
  for (int a = 0; a < 3; ++a) {
    const double last = static_cast<double>(lattice_.counts[a] - 1);
    outside[a] = u[a] < 0 ? u[a] : u[a] > last ? u[a] - last : 0;
  }
  const double q2 = dot(outside, outside);
  const Spline::Value edge = spline_.at(u, q2 > 0);
  Vector by_lattice = edge.gradient;
  constexpr int kOf[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  for (int a = 0; a < 3; ++a)
    if (outside[a] != 0)
      by_lattice[a] += rise_ * outside[a] / std::sqrt(4 + q2);
    else
      for (int b = 0; b < 3; ++b) by_lattice[a] += edge.hessian[kOf[a][b]] * outside[b];
  const Vector g = lattice_.gradient(by_lattice);
  std::copy(g.begin(), g.end(), gradient);
  return edge.value + dot(edge.gradient, outside) + rise_ * (std::sqrt(4 + q2) - 2);
}

// The spline can be steeper between the points than at them: around the steepest ones it is looked
// at half a step away, too.
void Field::find_steepest() {
  const auto& n = lattice_.counts;
  const auto slope = [this](const Vector& u) {
    return length(lattice_.gradient(spline_.at(u, false).gradient));
  };
  std::vector<double> slopes;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i)
        slopes.push_back(
            slope({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
  std::vector<double> ordered = slopes;
  const std::size_t looked = std::min<std::size_t>(4096, slopes.size());
  std::nth_element(ordered.begin(), ordered.begin() + (looked - 1), ordered.end(),
                   std::greater<>());
  std::size_t left = looked;
  for (std::size_t p = 0; p < slopes.size() && left > 0; ++p) {
    if (!(slopes[p] >= ordered[looked - 1])) continue;
    --left;
    const std::array<std::size_t, 3> at{p % n[0], p / n[0] % n[1], p / n[0] / n[1]};
    for (int step = 0; step < 27; ++step) {
      Vector u;
      for (int a = 0, rest = step; a < 3; ++a, rest /= 3)
        u[a] = std::clamp(static_cast<double>(at[a]) + (rest % 3 - 1) / 2.0, 0.0,
                          static_cast<double>(n[a] - 1));
      steepest_ = std::max(steepest_, slope(u));
    }
  }
}

void Field::find_minima(const std::vector<double>& values) {
  const auto& n = lattice_.counts;
  std::vector<std::pair<double, Vector>> found;
  const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(n[0]),
                       plane = row * static_cast<std::ptrdiff_t>(n[1]);
  // Of neighbours with the same value the first one counts.
  std::vector<std::ptrdiff_t> before;
  for (std::ptrdiff_t z = -1; z <= 0; ++z)
    for (std::ptrdiff_t y = -1; y <= 1; ++y)
      for (std::ptrdiff_t x = -1; x <= 1; ++x)
        if (const std::ptrdiff_t step = x + row * y + plane * z;
            z < 0 || y < 0 || (y == 0 && x < 0))
          before.push_back(step);
  for (std::size_t k = 1; k + 1 < n[2]; ++k)
    for (std::size_t j = 1; j + 1 < n[1]; ++j)
      for (std::size_t i = 1; i + 1 < n[0]; ++i) {
        const double* v = &values[i + n[0] * j + n[0] * n[1] * k];
        if (std::all_of(before.begin(), before.end(),
                        [v](std::ptrdiff_t step) { return *v < v[step] && *v <= v[-step]; }))
          found.emplace_back(*v, lattice_.place({i, j, k}));
      }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  if (found.size() > kMostMinima) found.resize(kMostMinima);
  for (const auto& [value, x] : found) minima_.push_back(x);
}

}  // namespace hapgrid::table
