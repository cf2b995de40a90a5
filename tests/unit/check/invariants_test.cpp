#include "libcore/check/invariants.hpp"

#include <algorithm>
#include <map>

#include "tests/unit/catch.hpp"
#include "tests/unit/check/tiny_grid.hpp"

using namespace hapgrid;

namespace {

std::vector<Check> all_checks(const Grid& grid) {
  const std::vector<std::uint32_t> distances = find_distances(grid);
  std::vector<Check> checks{check_complete(grid),
                            check_coverage(grid),
                            check_links(grid),
                            check_finite(grid),
                            check_distinct(grid, *tiny::model()),
                            check_reachable(grid, distances),
                            check_generations(grid, distances)};
  std::atomic<std::uint64_t> done{0};
  checks.push_back(check_fidelity(
      grid, sample_records(grid, 1000, 1), [] { return tiny::model(); }, 1, done));
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
