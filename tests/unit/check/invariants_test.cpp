#include "libcore/check/invariants.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <map>
#include <utility>

#include "libcore/check/blends.hpp"
#include "libcore/check/reachable.hpp"
#include "tests/unit/check/tiny_grid.hpp"

using namespace hapgrid;

namespace {

std::vector<Check> all_checks(const Grid& grid, double tolerance = 1e-6) {
  std::vector<Check> checks = check_invariants(grid, tiny::model(tolerance).same);
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

TEST_CASE("blends are the cells at the two tear-offs") {
  // From level 1 of point 1 (state -1) the left end is reached, and from there level 0 (+1).
  const auto check = check_blends(tiny::grid(), 1);
  CHECK(check.is_note);
  CHECK(check.found.counted == 3);
  CHECK(tiny::texts(check.found) ==
        std::vector<std::string>{"cell (0, 0, 0) from point 1 (1, 0, 0) level 1",
                                 "cell (2, 0, 0) from point 2 (2, 0, 0) level 1"});
  CHECK(check_blends(tiny::after_one_round(), 1).found.offenders == 0);
}

TEST_CASE("only the first five offenders are described") {
  RecordColumns records;
  for (PointIndex p = 0; p < 9; ++p) tiny::add(records, p, 0, 7, 0, kLeavesBox, kLeavesBox);
  GridSpec spec = tiny::spec();
  spec.box.counts = {9, 1, 1};
  const Grid grid(spec, 7, records);
  const auto check = check_invariants(grid, tiny::model().same)[0];
  CHECK(check.found.offenders == 9);
  CHECK(check.found.first.size() == 5);
  CHECK(check.found.first.back().text == "point 4 (4, 0, 0) level 0");
}

namespace {

/// Whatever the rows say, those on distances must be what the whole grid gives.
void check_distances(const Grid& grid) {
  const std::vector<Check> all = check_invariants(grid, tiny::model().same);
  const std::vector<Check> expected = check_reachable(grid);
  for (std::size_t i = 0; i < 2; ++i) {
    const Check& row = all[all.size() - 2 + i];
    CHECK(row.name == expected[i].name);
    CHECK(row.found.counted == expected[i].found.counted);
    CHECK(row.found.offenders == expected[i].found.offenders);
    CHECK(row.found.first == expected[i].found.first);
  }
}

}  // namespace

TEST_CASE("distances that records tell one by one are those in the whole grid") {
  // All generations and links that the tiny grid can have, one or two of them changed.
  for (RecordIndex r = 0; r < 6; ++r)
    for (std::uint32_t generation = 0; generation < 5; ++generation)
      for (RecordIndex s = 0; s < 6; ++s)
        for (const int q : {tiny::kLeft, tiny::kRight})
          for (const Level level : {Level{0}, Level{1}, Level{2}, kUnsettled, kLeavesBox}) {
            RecordColumns records = tiny::records();
            records.generation[r] = generation;
            tiny::link(records, s, q) = level;
            CAPTURE(r, generation, s, q, int{level});
            check_distances(Grid(tiny::spec(), tiny::kGeneration, records));
          }
}

namespace {

constexpr PointIndex kCentre = 62;

/// 5 x 5 x 5 points of one level each, found from the point 0: most have nothing else around.
RecordColumns cube(GridSpec& spec) {
  spec = tiny::spec();
  spec.box.counts = {5, 5, 5};
  spec.tears = true;
  const Neighbourhood around(spec.box);
  RecordColumns records;
  for (PointIndex p = 0; p < spec.box.points(); ++p) {
    const GridCoordinates c = spec.box.coordinates(p);
    tiny::add(records, p, 0, std::max({c[0], c[1], c[2]}), 0, kLeavesBox, kLeavesBox);
    for (int q = 0; q < kDirections; ++q)
      if (around.inside(c) >> q & 1) tiny::link(records, p, q) = 0;
  }
  records.tears.assign(records.links.size(), kNoTear);
  return records;
}

}  // namespace

TEST_CASE("points that have one level, as all around them") {
  GridSpec spec;
  RecordColumns records = cube(spec);
  const auto rows = [&] {
    return broken(check_invariants(Grid(spec, 5, records), tiny::model().same));
  };
  CHECK(rows() == Broken{});
  SECTION("a generation is wrong") {
    for (PointIndex p = 0; p < spec.box.points(); ++p)
      for (std::uint32_t generation = 0; generation < 6; ++generation) {
        const std::uint32_t right = std::exchange(records.generation[p], generation);
        check_distances(Grid(spec, 5, records));
        records.generation[p] = right;
      }
  }
  SECTION("no record is a seed") {
    for (PointIndex p = 0; p < spec.box.points(); ++p) {
      std::uint32_t away = 0;  // from the centre
      for (const std::uint32_t c : spec.box.coordinates(p))
        away = std::max(away, c > 2 ? c - 2 : 2 - c);
      records.generation[p] = 1 + away;
    }
    check_distances(Grid(spec, 5, records));
    CHECK(rows().at("reachable").size() == 5);
  }
  SECTION("a tear fraction is too many") {
    records.tears[kCentre * kDirections + tiny::kLeft] = 3;
    CHECK(rows() ==
          Broken{{"fractions",
                  {"point 62 (2, 2, 2) level 0 direction 12 (-1, 0, 0): not one-way, with tear "
                   "fraction 3"}}});
  }
  SECTION("a record of the frontier has links") {
    records.generation[kCentre] = 5;
    CHECK(rows().at("complete").size() == 1);
    CHECK(rows().at("links").front() ==
          "point 62 (2, 2, 2) level 0 direction 0 (-1, -1, -1): destination level 0, but the "
          "record is in the frontier");
  }
}
