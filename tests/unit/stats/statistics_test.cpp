#include "tools/stats/statistics.hpp"

#include <nlohmann/json.hpp>

#include "tests/unit/catch.hpp"
#include "tests/unit/check/tiny_grid.hpp"

using namespace hapgrid;

TEST_CASE("statistics of the tiny grid, counted by hand") {
  const Statistics s = count_statistics(tiny::grid(), 1200);
  CHECK(s.points == 4);
  CHECK(s.points_reached == 4);
  CHECK(s.records == 6);
  CHECK(s.frontier == 0);
  CHECK(s.generation == 3);
  CHECK(s.generations == 3);
  CHECK(s.levels_histogram == std::vector<std::uint64_t>{0, 2, 2});
  // One conversion from each end, two from each of the four records between.
  CHECK(s.conversions == 10);
  CHECK(s.links == 10);
  // (1, -1) to the left end and back is (1, +1); (2, +1) to the right end and back is (2, -1).
  CHECK(s.one_way_links == 2);

  const auto json = statistics_json(tiny::spec(), s, nullptr);
  CHECK(json["average_levels"] == 1.5);
  CHECK(json["one_way_share"] == 0.2);
  CHECK(json["bytes_per_record"] == 200.0);
  CHECK(json["share_reached"] == 1.0);
  CHECK(json["cpu_hours"].is_null());
  CHECK(json["costs"].is_null());
  CHECK(json["parameters"]["probe.radius"] == 0.1);
  CHECK(json["box"]["counts"] == std::vector<int>{4, 1, 1});
}
