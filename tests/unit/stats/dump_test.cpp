#include "tools/stats/dump.hpp"

#include <catch2/catch.hpp>

#include "tests/unit/check/tiny_grid.hpp"

using namespace hapgrid;

TEST_CASE("the dump, literally") {
  std::string text;
  const Grid grid = tiny::grid();
  for (RecordIndex r = 0; r < 2; ++r) append_record(text, grid, r);
  append_record(text, tiny::after_one_round(), 1);
  const std::string twelve = "\t-\t-\t-\t-\t-\t-\t-\t-\t-\t-\t-\t-";
  CHECK(text == "0\t0\t0\t0\t0" + twelve + "\t-\t0" + twelve + "\n" + "1\t0\t0\t0\t1" + twelve +
                    "\t0\t1" + twelve + "\n" + "1\t0\t0\t0\t1" + twelve + "\t?\t?" + twelve + "\n");
}

TEST_CASE("a dump of several components, with all their digits") {
  GridSpec spec;
  spec.box = {{0, 0, 0}, 1, {1, 1, 1}};
  spec.state_size = 2;
  RecordColumns records{{0}, {0}, {0}, {0.1, -2.5}, std::vector<Level>(26, kLeavesBox)};
  std::string text;
  append_record(text, Grid(spec, 1, records), 0);
  CHECK(text.substr(0, 35) == "0\t0\t0\t0\t0.10000000000000001\t-2.5\t-\t");
}
