#include "tools/stats/statistics.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "libcore/base/error.hpp"
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

TEST_CASE("statistics of an incomplete grid") {
  const Statistics s = count_statistics(tiny::after_one_round(), 100);
  CHECK(s.frontier == 2);
  CHECK(s.generations == 2);
  CHECK(s.conversions == 2);
  CHECK(s.links == 0);  // the way back from the frontier is not known yet
  const auto json = statistics_json(tiny::spec(), s, nullptr);
  CHECK(json["one_way_share"].is_null());
  CHECK(json["average_levels"] == 1.0);

  const Statistics none = count_statistics(Grid(tiny::spec(), 0, {}), 100);
  CHECK(none.generations == 0);
  CHECK(none.points_reached == 0);
  CHECK(statistics_json(tiny::spec(), none, nullptr)["average_levels"].is_null());
}

TEST_CASE("what is still to be done: the frontier, then the tear fractions that are wanted") {
  CHECK(count_statistics(tiny::after_one_round(), 100).todo == 2);
  CHECK(count_statistics(tiny::grid(), 100).todo == 0);
  GridSpec spec = tiny::spec();
  spec.tears = true;
  RecordColumns records = tiny::records();
  const Statistics lacking = count_statistics(Grid(spec, 3, records), 1200);
  CHECK(lacking.todo == 6);
  CHECK_THAT(
      statistics_text(spec, lacking, nullptr),
      Catch::Matchers::Contains("to the level), whose tear fractions are still to be found\n"));
  records.tears.assign(records.links.size(), kNoTear);
  const Statistics torn = count_statistics(Grid(spec, 3, records), 1200);
  CHECK(torn.todo == 0);
  CHECK(statistics_json(spec, torn, nullptr)["tears"] == true);
  CHECK_THAT(statistics_text(spec, torn, nullptr),
             Catch::Matchers::Contains("to the level), with tear fractions\n"));
}

TEST_CASE("a seed record in the frontier at one of two points") {
  RecordColumns seeds;
  tiny::add(seeds, 0, 0, 0, 0, kLeavesBox, kUnsettled);
  const Statistics s = count_statistics(Grid(tiny::spec(), 0, seeds), 100);
  CHECK(s.points_reached == 1);
  CHECK(s.levels_histogram == std::vector<std::uint64_t>{3, 1});
  const auto json = statistics_json(tiny::spec(), s, nullptr);
  CHECK(json["average_levels"] == 1.0);  // over the points that have a level
  CHECK(json["share_reached"] == 0.25);
}

TEST_CASE("the statistics as text") {
  CostSums sums{2, 12, 3, 5400};
  CHECK(statistics_text(tiny::spec(), count_statistics(tiny::grid(), 1200), &sums) ==
        "model        tiny\n"
        "parameter    name = \"x\\ufffd\\n\"\n"
        "parameter    probe.radius = 0.1\n"
        "box          4 x 1 x 1 points, 0.25 apart, from (0.5, 0, 0) to (1.25, 0, 0)\n"
        "state        1 component, tolerance 1e-06 m\n"
        "points       4, of these 4 reached (100.00 %)\n"
        "records      6 in 3 generations\n"
        "frontier     0 records (complete)\n"
        "levels       1: 2, 2: 2 (levels: points that have so many; at most 64)\n"
        "one-way      20.00 % of 10 links (there and back does not return to the level)\n"
        "conversions  10 that this grid needed, 12 in the cost files, and 3 for tear fractions\n"
        "size         1200 bytes, 200.00 a record\n"
        "\n"
        "model  avg. levels  data size  CPU hours\n"
        "tiny         1.500   0.001 MB        1.5\n"
        "(average levels: records per point that has a level; data size: the grid as stored, in\n"
        "10^6 bytes; CPU hours: the sum of --cost)\n");
}

TEST_CASE("cost files add up") {
  CostSums sums;
  add_costs(sums, "a",
            "{\"tool\":\"expand\",\"wall_seconds\":1,\"cpu_seconds\":1.5,\"conversions\":100,"
            "\"tear_conversions\":20,\"host\":\"h\",\"generation\":0,\"part\":1,\"parts\":2}\n"
            "{\"tool\":\"merge\",\"cpu_seconds\":2,\"conversions\":0,\"tear_conversions\":1}\n");
  add_costs(sums, "b",
            "{\"cpu_seconds\": 1e-1, \"conversions\": 4000000000000, \"tear_conversions\": 0}");
  add_costs(sums, "c", "");
  CHECK(sums.lines == 3);
  CHECK(sums.cpu_seconds == Approx(3.6).epsilon(1e-15));
  CHECK(sums.conversions == 4000000000100u);
  CHECK(sums.tear_conversions == 21);
}

TEST_CASE("a malformed cost file is named with its line") {
  const std::string good = "{\"cpu_seconds\":1,\"conversions\":1,\"tear_conversions\":1}\n";
  const auto message = [](const std::string& text) {
    CostSums sums;
    try {
      add_costs(sums, "cost", text);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(message(good + good) == "");
  CHECK(message(good + "{\"cpu_seconds\":1,") == "cost: line 2: no JSON object");
  CHECK(message(good + "\n" + good) == "cost: line 2: no JSON object");
  CHECK(message("{\"x\":" + std::string(100'000, '[') + std::string(100'000, ']') + "}\n") ==
        "cost: line 1: no JSON object");
  CHECK(message("[1]\n") == "cost: line 1: no JSON object");
  const std::string seconds = "cost: line 1: \"cpu_seconds\" is no number of 0 or more";
  CHECK(message("{\"conversions\":1}") == seconds);
  CHECK(message("{\"cpu_seconds\":-1,\"conversions\":1}") == seconds);
  CHECK(message("{\"cpu_seconds\":\"1\",\"conversions\":1}") == seconds);
  const std::string conversions = "cost: line 1: \"conversions\" is no whole number of 0 or more";
  CHECK(message("{\"cpu_seconds\":1}") == conversions);
  CHECK(message("{\"cpu_seconds\":1,\"conversions\":-1}") == conversions);
  CHECK(message("{\"cpu_seconds\":1,\"conversions\":1.5}") == conversions);
  CHECK(message("{\"cpu_seconds\":1,\"conversions\":1}") ==
        "cost: line 1: \"tear_conversions\" is no whole number of 0 or more");
}
