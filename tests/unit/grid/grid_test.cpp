// What a grid in memory answers, and that a header of some bytes asks for little of it.
#include "libcore/grid/grid.hpp"

#include "libcore/base/error.hpp"
#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

/// A box with one record, at its first point.
Grid one_record(const GridCoordinates& counts) {
  GridSpec spec;
  spec.box = {{0, 0, 0}, 1, counts};
  spec.state_size = 1;
  const std::vector<Level> links(kDirections, kLeavesBox);
  return Grid(
      spec, 0,
      RecordColumns{.point = {0}, .level = {0}, .generation = {0}, .rows = {0.5}, .links = links});
}

}  // namespace

TEST_CASE("a large box that is nearly empty is no grid") {
  CHECK(one_record({256, 256, 256}).levels(0) == 1);
  CHECK_THROWS_AS(one_record({256, 256, 257}), FormatError);
  CHECK_THROWS_AS(one_record({65536, 65535, 1}), FormatError);
}

TEST_CASE("a grid knows each point's records and each record's row, whatever the runs") {
  std::mt19937_64 random(1);
  const bool has_one_level = GENERATE(false, true), has_gaps = GENERATE(false, true);
  if (has_one_level && has_gaps) return;
  GridSpec spec;
  spec.box = {{0, 0, 0}, 1, {700, 3, 1}};
  spec.state_size = 2;
  RecordColumns columns;
  std::vector<RecordIndex> first;
  for (PointIndex p = 0; p < spec.box.points(); ++p) {
    first.push_back(static_cast<RecordIndex>(columns.size()));
    // Long stretches of one level, as in real grids.
    const bool is_busy = p / 150 % 2 == 1 && !has_one_level;
    const std::uint64_t levels = is_busy ? random() % 4 + (has_gaps ? 0 : 1) : 1;
    for (std::uint64_t l = 0; l < levels; ++l) {
      columns.point.push_back(p);
      columns.level.push_back(static_cast<Level>(l));
      columns.generation.push_back(p);
      const double state = is_busy ? static_cast<double>(columns.size()) : 0;
      columns.rows.insert(columns.rows.end(), {state, -state});
      columns.links.insert(columns.links.end(), kDirections, kLeavesBox);
    }
  }
  first.push_back(static_cast<RecordIndex>(columns.size()));
  GridBuilder builder(spec, 5000, columns.size());
  std::vector<std::size_t> cuts{0, columns.size()};
  for (int i = 0; i < 40; ++i) cuts.push_back(random() % columns.size());
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t i = cuts.size() - 1; i > 0; --i) {  // the last run comes first
    const auto run = [&](const auto& column, std::size_t width) {
      return std::span(column).subspan(cuts[i - 1] * width, (cuts[i] - cuts[i - 1]) * width);
    };
    builder.add(cuts[i - 1],
                {run(columns.point, 1), run(columns.level, 1), run(columns.generation, 1),
                 run(columns.rows, 2), run(columns.links, kDirections)});
  }
  const Grid grid = builder.finish();
  REQUIRE(grid.records() == columns.size());
  for (PointIndex p = 0; p < spec.box.points(); ++p) {
    REQUIRE(grid.first(p) == first[p]);
    REQUIRE(grid.levels(p) == first[p + 1] - first[p]);
  }
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    REQUIRE(grid.point(r) == columns.point[r]);
    REQUIRE(grid.level(r) == columns.level[r]);
    REQUIRE(grid.record_generation(r) == columns.generation[r]);
    REQUIRE(grid.row(r)[0] == columns.rows[2 * r]);
    REQUIRE(grid.row(r)[1] == columns.rows[2 * r + 1]);
  }
}
