#include "libcore/check/precision.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"
#include "libcore/check/text.hpp"

namespace hapgrid {

namespace {

std::string column_text(const GridSpec& spec, std::size_t c) {
  return c < spec.state_size ? "component " + std::to_string(c)
                             : "stored number " + std::to_string(c - spec.state_size);
}

std::vector<double> state_bounds(const LoadedGrid& loaded) {
  const std::vector<double>& all = loaded.coding.bounds;
  return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(loaded.grid.state_size())};
}

/// What forgiving() is made of: knows the last conversion.
class ForgivingConversion {
 public:
  ForgivingConversion(const ModelFunctions& model, const LoadedGrid& loaded)
      : model_(model),
        bounds_(state_bounds(loaded)),
        near_(bounds_.size()),
        row_(loaded.grid.spec().row_size()) {}

  bool convert(const double* s, const Vec3& x, const Vec3& d, double* row, std::string& error) {
    start_.assign(s, s + bounds_.size());
    x_ = x;
    d_ = d;
    return model_.convert(s, x, d, row, error);
  }

  bool is_same(const double* reached, const double* stored) {
    if (is_near(reached, stored)) return true;
    // Of many components a few: each costs two conversions.
    const std::size_t tried = std::min<std::size_t>(bounds_.size(), 16);
    for (const double sign : {1.0, -1.0}) {
      for (std::size_t c = 0; c < bounds_.size(); ++c) moved_[c] = start_[c] + sign * bounds_[c];
      if (reaches(stored)) return true;
      for (std::size_t c = 0; c < tried; ++c) {
        moved_ = start_;
        moved_[c] += sign * bounds_[c];
        if (reaches(stored)) return true;
      }
    }
    return false;
  }

 private:
  bool is_near(const double* reached, const double* stored) {
    // As they are first: the model may know better what is near, as of angles.
    if (model_.same(reached, stored)) return true;
    for (std::size_t c = 0; c < bounds_.size(); ++c)
      near_[c] = std::clamp(reached[c], stored[c] - 2 * bounds_[c], stored[c] + 2 * bounds_[c]);
    return model_.same(reached, near_.data());
  }

  /// From the start as it is moved.
  bool reaches(const double* stored) {
    std::string error;
    return model_.convert(moved_.data(), x_, d_, row_.data(), error) &&
           is_near(row_.data(), stored);
  }

  ModelFunctions model_;
  std::vector<double> bounds_;
  std::vector<double> near_;
  std::vector<double> row_;
  std::vector<double> start_;
  std::vector<double> moved_ = bounds_;
  Vec3 x_{};
  Vec3 d_{};
};

// Of a few operations, each off by half a unit in the last place: 1e-16.
constexpr double kRounding = 1e-14;

}  // namespace

ModelFunctions forgiving(ModelFunctions model, const LoadedGrid& loaded) {
  if (!loaded.coding.is_lossy()) return model;
  const auto conversion = std::make_shared<ForgivingConversion>(model, loaded);
  model.convert_many = nullptr;
  model.convert = [conversion](const double* s, const Vec3& x, const Vec3& d, double* row,
                               std::string& error) {
    return conversion->convert(s, x, d, row, error);
  };
  model.same = [conversion](const double* reached, const double* stored) {
    return conversion->is_same(reached, stored);
  };
  return model;
}

SameState same_in_spite_of(SameState same, const LoadedGrid& loaded) {
  if (!loaded.coding.is_lossy()) return same;
  const std::vector<double> bounds = state_bounds(loaded);
  return [same = std::move(same), bounds, moved_a = bounds, moved_b = bounds](
             const double* a, const double* b) mutable {
    for (std::size_t c = 0; c < bounds.size(); ++c) {
      const double apart = a[c] < b[c] ? -bounds[c] : bounds[c];
      moved_a[c] = a[c] + apart;
      moved_b[c] = b[c] - apart;
    }
    return same(moved_a.data(), moved_b.data());
  };
}

Check check_precision(const LoadedGrid& loaded) {
  const Grid& grid = loaded.grid;
  const Coding& coding = loaded.coding;
  Check check{"precision",
              "columns",
              "columns of numbers whose bound is more than the precision " +
                  to_text(coding.precision) + " of their range",
              {}};
  const std::size_t width = coding.bounds.size();
  std::vector<double> least(width, std::numeric_limits<double>::infinity());
  std::vector<double> most(width, -std::numeric_limits<double>::infinity());
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (std::size_t c = 0; c < width; ++c) {
      const double v = grid.row(r)[c];
      if (!std::isfinite(v)) continue;
      least[c] = std::min(least[c], v);
      most[c] = std::max(most[c], v);
    }
  for (std::size_t c = 0; c < width; ++c) {
    const double bound = coding.bounds[c];
    if (bound == 0) continue;
    ++check.found.counted;
    // The ends of the range may be off themselves, and the sums are rounded.
    const double range = most[c] - least[c] + 2 * bound;
    if (bound <= coding.precision * range * (1 + kRounding)) continue;
    check.found.offend([&] {
      return column_text(grid.spec(), c) + ": bound " + to_text(bound) + ", numbers from " +
             to_text(least[c]) + " to " + to_text(most[c]);
    });
  }
  return check;
}

Check check_precision(const LoadedGrid& loaded, const LoadedGrid& original) {
  const Grid& grid = loaded.grid;
  const Grid& was = original.grid;
  if (original.coding.is_lossy())
    throw Error("the original may be off itself, by " + to_text(original.coding.precision) +
                " of each range");
  if (grid.spec() != was.spec())
    throw Error("the original is another grid: " + difference(grid.spec(), was.spec()));
  if (grid.generation() != was.generation() || grid.records() != was.records())
    throw Error("the original has " + std::to_string(was.records()) + " records in generation " +
                std::to_string(was.generation()) + ", not " + std::to_string(grid.records()) +
                " in generation " + std::to_string(grid.generation()));
  Check check{"precision",
              "numbers",
              loaded.coding.is_lossy()
                  ? "differences from the original beyond the bounds of precision " +
                        to_text(loaded.coding.precision) + ", or of links"
                  : "differences from the original",
              {}};
  const auto is_same = [](double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  };
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    if (grid.point(r) != was.point(r) || grid.level(r) != was.level(r) ||
        grid.record_generation(r) != was.record_generation(r) ||
        !std::ranges::equal(grid.links(r), was.links(r)))
      check.found.offend([&] {
        return describe(grid, r) + ": point, level, generation or destination levels are other";
      });
    for (std::size_t c = 0; c < grid.row(r).size(); ++c) {
      ++check.found.counted;
      const double a = grid.row(r)[c], b = was.row(r)[c];
      const double bound = loaded.coding.is_lossy() ? loaded.coding.bounds[c] : 0;
      if (is_same(a, b) || (bound > 0 && std::abs(a - b) <= bound)) continue;
      check.found.offend([&] {
        return describe(grid, r) + ": " + column_text(grid.spec(), c) + " is " + to_text(a) +
               ", the original's " + to_text(b) + ", the bound " + to_text(bound);
      });
    }
  }
  return check;
}

}  // namespace hapgrid
