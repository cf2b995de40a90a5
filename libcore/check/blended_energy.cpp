#include "libcore/check/blended_energy.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "libcore/base/text.hpp"
#include "libcore/grid/cell.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

class BlendSurvey {
 public:
  BlendSurvey(const Grid& grid, const Fields& fields)
      : grid_(grid), cells_(grid), fields_(fields), row_(grid.spec().row_size()) {}

  const Cells& cells() const { return cells_; }
  const BlendedEnergy& seen() const { return seen_; }
  bool has_cell(PointIndex base) const {
    const GridCoordinates c = grid_.box().coordinates(base);
    for (int a = 0; a < 3; ++a)
      if (c[a] >= cells_.count(a)) return false;
    return true;
  }

  /// @param rows by corner; along a flat axis both corners are the same
  void look_at(PointIndex base, const std::array<const double*, 8>& rows) {
    ++seen_.cells;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    std::fill(row_.begin(), row_.end(), 0.0);
    Vec3 middle{0, 0, 0};
    for (int k = 0; k < 8; ++k) {
      const Vec3 x = grid_.box().position(cells_.point(base, k));
      const double energy = fields_.energy(x, {rows[k], row_.size()});
      low = std::min(low, energy);
      high = std::max(high, energy);
      for (std::size_t c = 0; c < row_.size(); ++c) row_[c] += rows[k][c] / 8;
      for (int a = 0; a < 3; ++a) middle[a] += x[a] / 8;
    }
    const double energy = fields_.energy(middle, row_);
    const double leaves = std::max(energy - high, low - energy);
    if (!(leaves > seen_.leaves)) return;
    seen_.leaves = leaves;
    seen_.base = base;
  }

 private:
  const Grid& grid_;
  const Cells cells_;
  const Fields& fields_;
  std::vector<double> row_;
  BlendedEnergy seen_;
};

std::array<const double*, 8> rows_of(const Grid& grid, const std::array<RecordIndex, 8>& records) {
  std::array<const double*, 8> rows;
  std::transform(records.begin(), records.end(), rows.begin(),
                 [&](RecordIndex r) { return grid.row(r).data(); });
  return rows;
}

}  // namespace

std::vector<Figure> BlendedEnergy::figures(const GridSpec& spec, const Box& box) const {
  if (cells == 0) return {};
  return {{"blended energy", leaves, printable_line(spec.energy_unit),
           "how far the energy in the middle of such a cell leaves those of its corners" +
               (leaves > 0 ? ", at most: at " + describe(box, base) : "")}};
}

bool can_ask_energy(const GridSpec& spec, const Fields& fields) {
  return fields.has_energy() && !spec.stored.energy;
}

BlendedEnergy energy_of_branches(const Grid& grid, const Sheets& sheets, const Fields& fields) {
  BlendSurvey survey(grid, fields);
  const Neighbourhood& around = grid.neighbourhood();
  const auto look = [&](RecordIndex r, int own) {
    std::array<const double*, 8> rows{};
    bool is_whole = survey.cells().is_corner(own);
    std::int64_t base = grid.point(r);
    for (int k = 0; k < 8 && is_whole; ++k) {
      const int corner = survey.cells().is_corner(k) ? k : own;
      const auto q = kBetweenCorners[own][corner];
      const Node node = q < 0 ? r : sheets.node(r, q);
      is_whole = node != Sheets::kNoNode;
      if (is_whole) rows[k] = sheets.row(node);
      if (k == 0 && q >= 0) base += around.offset(q);
    }
    if (is_whole) survey.look_at(static_cast<PointIndex>(base), rows);
  };
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (int own = 0; own < 8; ++own)
      if (sheets.is_mixed(r, own)) look(r, own);
  return survey.seen();
}

BlendedEnergy energy_of_configurations(const Grid& grid, const Configurations& found,
                                       const Fields& fields) {
  BlendSurvey survey(grid, fields);
  const auto pairs = corner_pairs(survey.cells());
  for (const Configuration& configuration : found.listed) {
    const Corners corners = corners_of(grid, survey.cells(), configuration);
    if (is_mixed(grid, pairs, corners))
      survey.look_at(configuration.base, rows_of(grid, corners.record));
  }
  return survey.seen();
}

BlendedEnergy energy_of_blends(const Grid& grid, const Fields& fields) {
  BlendSurvey survey(grid, fields);
  const auto pairs = corner_pairs(survey.cells());
  for (PointIndex base = 0; base < grid.box().points(); ++base) {
    // With one level in each corner nothing can be mixed.
    bool has_choice = false;
    const bool is_cell = survey.has_cell(base);
    for (int k = 0; is_cell && k < 8; ++k)
      has_choice |= survey.cells().is_corner(k) && grid.levels(survey.cells().point(base, k)) > 1;
    if (!has_choice) continue;
    for (int own = 0; own < 8; ++own) {
      const PointIndex point = survey.cells().point(base, own);
      for (Level level = 0; survey.cells().is_corner(own) && level < grid.levels(point); ++level) {
        Corners corners;
        if (survey.cells().start(base, own, corners, level) && is_mixed(grid, pairs, corners))
          survey.look_at(base, rows_of(grid, corners.record));
      }
    }
  }
  return survey.seen();
}

}  // namespace hapgrid
