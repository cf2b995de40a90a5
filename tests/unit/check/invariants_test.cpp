#include "libcore/check/invariants.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <map>

#include "tests/unit/check/tiny_grid.hpp"

using namespace hapgrid;

namespace {

std::vector<Check> all_checks(const Grid& grid, double tolerance = 1e-6) {
  const std::vector<std::uint32_t> distances = find_distances(grid);
  std::vector<Check> checks{check_complete(grid),
                            check_coverage(grid),
                            check_links(grid),
                            check_finite(grid),
                            check_distinct(grid, *tiny::model(tolerance)),
                            check_reachable(grid, distances),
                            check_generations(grid, distances)};
  if (grid.has_tears()) checks.push_back(check_fractions(grid));
  std::atomic<std::uint64_t> done{0};
  checks.push_back(check_fidelity(
      grid, sample_records(grid, 1000, 1), [&] { return tiny::model(tolerance); }, 1, done));
  return checks;
}

/// The offenders of the checks that are broken.
using Broken = std::map<std::string, std::vector<std::string>>;
Broken broken(const std::vector<Check>& checks) {
  Broken broken;
  for (const Check& check : checks) {
    CHECK(check.found.first.size() == std::min<std::uint64_t>(check.found.offenders, 5));
    if (check.found.offenders > 0) broken[check.name] = tiny::texts(check.found);
  }
  return broken;
}

Broken broken(const RecordColumns& records) {
  return broken(all_checks(Grid(tiny::spec(), tiny::kGeneration, records)));
}

}  // namespace

TEST_CASE("a sound grid passes, and each check counts what it says") {
  const auto checks = all_checks(tiny::grid());
  CHECK(broken(checks) == Broken{});
  std::map<std::string, std::uint64_t> counted;
  for (const Check& check : checks) counted[check.name] = check.found.counted;
  CHECK(counted == std::map<std::string, std::uint64_t>{{"complete", 6},
                                                        {"coverage", 4},
                                                        {"links", 6 * 26},
                                                        {"finite", 6},
                                                        {"distinct", 2},
                                                        {"reachable", 6},
                                                        {"generations", 6},
                                                        {"fidelity", 10}});
}

TEST_CASE("records that wait in the frontier are only incomplete") {
  CHECK(broken(all_checks(tiny::after_one_round())) ==
        Broken{{"complete", {"point 1 (1, 0, 0) level 0", "point 2 (2, 0, 0) level 0"}}});
}

TEST_CASE("an empty grid covers nothing") {
  const auto found = broken(all_checks(Grid(tiny::spec(), 0, {})));
  REQUIRE(found.size() == 1);
  CHECK(found.at("coverage").size() == 4);
}

TEST_CASE("links that cannot be") {
  auto records = tiny::records();
  SECTION("to a level that does not exist") {
    tiny::link(records, 2, tiny::kLeft) = 7;
    CHECK(broken(records) ==
          Broken{{"links",
                  {"point 1 (1, 0, 0) level 1 direction 12 (-1, 0, 0): destination level 7, but "
                   "point 0 (0, 0, 0) has 1 levels"}}});
  }
  SECTION("inside, but marked as leaving the box") {
    tiny::link(records, 2, tiny::kLeft) = kLeavesBox;
    CHECK(broken(records) ==
          Broken{{"links",
                  {"point 1 (1, 0, 0) level 1 direction 12 (-1, 0, 0): marked as leaving the box, "
                   "but it stays inside"}}});
  }
  SECTION("outside, but with a level") {
    tiny::link(records, 0, tiny::kLeft) = 0;
    tiny::link(records, 5, 0) = 3;
    tiny::link(records, 5, 25) = kUnsettled;
    CHECK(broken(records) ==
          Broken{{"links",
                  {"point 0 (0, 0, 0) level 0 direction 12 (-1, 0, 0): destination level 0, but "
                   "the direction leaves the box",
                   "point 3 (3, 0, 0) level 0 direction 0 (-1, -1, -1): destination level 3, but "
                   "the direction leaves the box",
                   "point 3 (3, 0, 0) level 0 direction 25 (1, 1, 1): destination level 254, but "
                   "the direction leaves the box"}}});
  }
  SECTION("not settled outside the frontier") {
    tiny::link(records, 2, tiny::kLeft) = kUnsettled;
    CHECK(broken(records) ==
          Broken{{"links",
                  {"point 1 (1, 0, 0) level 1 direction 12 (-1, 0, 0): not settled, but the record "
                   "is not in the frontier"}}});
  }
}

TEST_CASE("a state that is not finite") {
  auto records = tiny::records();
  records.rows[2] = std::numeric_limits<double>::quiet_NaN();
  records.rows[4] = -std::numeric_limits<double>::infinity();
  CHECK(broken(records) == Broken{{"finite",
                                   {"point 1 (1, 0, 0) level 1: component 0 is nan",
                                    "point 2 (2, 0, 0) level 1: component 0 is -inf"}}});
}

TEST_CASE("levels that the tolerance function does not tell apart") {
  CHECK(broken(all_checks(tiny::grid(), 2.5)) ==
        Broken{{"distinct",
                {"point 1 (1, 0, 0) level 0 and level 1: states 1 and -1",
                 "point 2 (2, 0, 0) level 0 and level 1: states -1 and 1"}}});
}

TEST_CASE("an island that is sound in itself, but that no link leads to") {
  RecordColumns records;
  tiny::add(records, 0, 0, 0, 0, kLeavesBox, 0);
  tiny::add(records, 1, 0, 1, +1, 0, 1);
  tiny::add(records, 1, 1, 2, -1, 0, 0);
  tiny::add(records, 1, 2, 2, 5, 0, 2);
  tiny::add(records, 2, 0, 1, -1, 1, 0);
  tiny::add(records, 2, 1, 2, +1, 0, 0);
  tiny::add(records, 2, 2, 2, 5, 2, 0);
  tiny::add(records, 3, 0, 0, 0, 0, kLeavesBox);
  CHECK(broken(records) ==
        Broken{{"reachable", {"point 1 (1, 0, 0) level 2", "point 2 (2, 0, 0) level 2"}}});
}

TEST_CASE("a generation that is not the distance from the seeds") {
  auto records = tiny::records();
  SECTION("too small") {
    records.generation[2] = 1;
    CHECK(broken(records) ==
          Broken{{"generations", {"point 1 (1, 0, 0) level 1: generation 1, distance 2"}}});
  }
  SECTION("too large") {
    records.generation[1] = 2;
    CHECK(broken(records) ==
          Broken{{"generations", {"point 1 (1, 0, 0) level 0: generation 2, distance 1"}}});
  }
}

TEST_CASE("only the first five offenders are described") {
  RecordColumns records;
  for (PointIndex p = 0; p < 9; ++p) tiny::add(records, p, 0, 7, 0, kLeavesBox, kLeavesBox);
  GridSpec spec = tiny::spec();
  spec.box.counts = {9, 1, 1};
  const Grid grid(spec, 7, records);
  const Check check = check_complete(grid);
  CHECK(check.found.offenders == 9);
  CHECK(check.found.first.size() == 5);
  CHECK(check.found.first.back().text == "point 4 (4, 0, 0) level 0");
}

TEST_CASE("a grid without seeds reaches nothing, and one that says it is rounds younger is named") {
  auto records = tiny::records();
  SECTION("no record is a seed") {
    records.generation[0] = records.generation[5] = 1;
    CHECK(broken(records).at("reachable").size() == 5);
  }
  SECTION("a round too many") {
    CHECK(broken(all_checks(Grid(tiny::spec(), tiny::kGeneration + 1, records))) ==
          Broken{{"generations", {"the grid has generation 4, its youngest record 2"}}});
  }
  SECTION("the levels of a point in the wrong order") {
    // From the left seed both levels of point 1 are reached at once, the lower one says later.
    RecordColumns two;
    tiny::add(two, 0, 0, 0, 0, kLeavesBox, 1);
    tiny::add(two, 1, 0, 2, +1, 0, 0);
    tiny::add(two, 1, 1, 1, -1, 0, 0);
    tiny::add(two, 2, 0, 2, -1, 0, kLeavesBox);
    GridSpec spec = tiny::spec();
    spec.box.counts = {3, 1, 1};
    two.generation = {0, 3, 1, 2};
    CHECK(
        tiny::texts(check_generations(Grid(spec, 4, two), {0, 3, 1, 2}).found) ==
        std::vector<std::string>{"point 1 (1, 0, 0) level 1: generation 1, the level below has 3"});
  }
}

TEST_CASE("a record of the frontier that has links") {
  const auto found = broken(all_checks(Grid(tiny::spec(), 2, tiny::records())));
  CHECK(found.at("complete").size() == 2);
  CHECK(found.at("links").front() ==
        "point 1 (1, 0, 0) level 1 direction 12 (-1, 0, 0): destination level 0, but the record is "
        "in the frontier");
}

TEST_CASE("tear fractions are where links are one-way") {
  auto records = tiny::records();
  records.tears.assign(records.links.size(), kNoTear);
  const auto tear = [&](RecordIndex r, int q) -> TearByte& {
    return records.tears[std::size_t{r} * kDirections + static_cast<std::size_t>(q)];
  };
  tear(2, tiny::kLeft) = tear(4, tiny::kRight) = 16;
  GridSpec spec = tiny::spec();
  spec.tears = true;
  const auto rows = [&] { return broken(all_checks(Grid(spec, tiny::kGeneration, records))); };
  CHECK(rows() == Broken{});
  tear(2, tiny::kLeft) = kNoTear;
  tear(1, tiny::kLeft) = 3;
  CHECK(rows() ==
        Broken{{"fractions",
                {"point 1 (1, 0, 0) level 0 direction 12 (-1, 0, 0): not one-way, with tear "
                 "fraction 3",
                 "point 1 (1, 0, 0) level 1 direction 12 (-1, 0, 0): one-way, without a tear "
                 "fraction"}}});
}
