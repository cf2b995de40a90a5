// The table of points is memory that a header of some bytes asks for.
#include "libcore/grid/grid.hpp"

#include <catch2/catch.hpp>

#include "libcore/base/error.hpp"

using namespace hapgrid;

namespace {

/// A box with one record, at its first point.
Grid one_record(const GridCoordinates& counts) {
  GridSpec spec;
  spec.box = {{0, 0, 0}, 1, counts};
  spec.state_size = 1;
  RecordColumns columns;
  columns.point = {0};
  columns.level = {0};
  columns.generation = {0};
  columns.rows = {0.5};
  columns.links.assign(kDirections, kLeavesBox);
  return Grid(spec, 0, std::move(columns));
}

}  // namespace

TEST_CASE("a large box that is nearly empty is no grid") {
  CHECK(one_record({256, 256, 256}).levels(0) == 1);
  CHECK_THROWS_AS(one_record({256, 256, 257}), FormatError);
  CHECK_THROWS_AS(one_record({65536, 65535, 1}), FormatError);
}
