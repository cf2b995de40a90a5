#include "libcore/check/paths.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/unit/check/oracle.hpp"
#include "tests/unit/check/tiny_grid.hpp"
#include "tests/unit/haptic/random_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

/// All of them, the simple cells' too.
std::set<Seen> places(const Grid& grid, const CellMap& map, const Configurations& found) {
  const Cells cells(grid);
  std::set<Seen> all;
  const auto add = [&](const Configuration& c) {
    CHECK(all.insert({grid.box().coordinates(c.base), corners_of(grid, cells, c).record}).second);
  };
  for (const Configuration& c : found.listed) add(c);
  for (std::uint64_t p = 0; p < grid.box().points(); ++p)
    if (map.exists(static_cast<PointIndex>(p)) && map.is_simple(static_cast<PointIndex>(p)))
      add({static_cast<PointIndex>(p), 0});
  return all;
}

std::map<std::string, Check> rows(const Grid& grid, int threads = 1) {
  const CellMap map(grid, threads);
  std::map<std::string, Check> rows;
  for (Check& check :
       check_paths(grid, map, find_configurations(grid, map, threads, kNoLimit), threads))
    rows.emplace(check.name, check);
  return rows;
}

/// Grids in which the oracle is quick; where one point in three has a choice, most cells have one
/// configuration in the first, and hundreds in the last.
std::vector<Grid> grids() {
  std::vector<Grid> grids;
  std::uint64_t seed = 0;
  for (const GridCoordinates& counts :
       {GridCoordinates{9, 1, 1}, {1, 6, 5}, {4, 1, 4}, {3, 3, 3}, {4, 3, 2}, {1, 1, 1}, {2, 2, 2}})
    for (const unsigned levels : {1u, 2u, 3u}) {
      const Box box{{-1, 0, 2}, 0.25, counts};
      if (box.points() > 20 && levels > 2) continue;
      grids.push_back(random_grid(box, 1, levels, ++seed));
    }
  return grids;
}

/// A grid with few levels: like real ones, and with a choice in the middle alone.
Grid sparse_grid(std::uint64_t seed) {
  const Box box{{0, 0, 0}, 1, {6, 5, 6}};
  std::mt19937_64 random(seed);
  const Neighbourhood around(box);
  std::vector<unsigned> count(box.points(), 1);
  for (std::uint32_t i = 2; i < 4; ++i)
    for (std::uint32_t j = 1; j < 4; ++j) count[box.index({i, j, 2})] = 2;
  RecordColumns columns;
  for (PointIndex p = 0; p < box.points(); ++p)
    for (unsigned l = 0; l < count[p]; ++l) {
      columns.point.push_back(p);
      columns.level.push_back(static_cast<Level>(l));
      columns.generation.push_back(0);
      columns.rows.push_back(static_cast<double>(random() % 100));
      for (int q = 0; q < kDirections; ++q)
        columns.links.push_back(
            around.inside(p) >> q & 1
                ? static_cast<Level>(random() %
                                     count[static_cast<std::size_t>(p + around.offset(q))])
                : kLeavesBox);
    }
  return Grid(spec_for(box, 1), 1, columns);
}

}  // namespace

TEST_CASE("what is enumerated is what the traversal can be in, no more and no less") {
  auto all = grids();
  for (const std::uint64_t seed : {1, 2, 3}) all.push_back(sparse_grid(seed));
  for (const Grid& grid : all) {
    const CellMap map(grid, 1);
    const Configurations found = find_configurations(grid, map, 1, kNoLimit);
    const Oracle oracle(grid);
    CHECK(places(grid, map, found) == oracle.places());
    CHECK(oracle.blocked == 0);

    const auto row = rows(grid, 2);
    CHECK(row.at("paths").found.counted == oracle.at.size());
    CHECK(row.at("paths").found.offenders == 0);
    CHECK(row.at("continuous").found.counted == oracle.switches);
    CHECK(row.at("continuous").found.offenders == 0);
    CHECK(row.at("one-way").found.offenders == oracle.one_way);
    CHECK(figure(row.at("one-way"), "switches") == static_cast<double>(oracle.one_way_switches));

    std::uint64_t mixed = 0;
    double gap = 0;
    std::set<GridCoordinates> cells;
    for (const auto& [place, t] : oracle.at) {
      bool is_mixed = false;
      for (const RecordIndex a : place.second)
        for (const RecordIndex b : place.second)
          for (int q = 0; q < kDirections; ++q) {
            const RecordIndex linked = grid.destination(a, q);
            if (linked == Grid::kNoRecord || grid.point(linked) != grid.point(b) || linked == b)
              continue;
            is_mixed = true;
            gap = std::max(gap, std::abs(grid.state(linked)[0] - grid.state(b)[0]));
          }
      mixed += is_mixed;
      if (is_mixed) cells.insert(place.first);
    }
    CHECK(row.at("mixed").found.offenders == mixed);
    CHECK(figure(row.at("mixed"), "cells") == static_cast<double>(cells.size()));
    CHECK(figure(row.at("mixed"), "largest gap") == gap);
  }
}

TEST_CASE("random walks and jumps meet nothing that was not enumerated") {
  for (const Grid& grid : grids()) {
    const CellMap map(grid, 2);
    const auto all = places(grid, map, find_configurations(grid, map, 2, kNoLimit));
    std::mt19937_64 random(7);
    std::set<Seen> visited;
    PaperTraversal t(grid);
    for (int i = 0; i < 20000; ++i) {
      Vec3 x;
      for (int a = 0; a < 3; ++a) {
        const double low = grid.box().origin[a];
        const double high = low + grid.box().spacing * (grid.box().counts[a] - 1);
        // Half of the moves are short.
        x[a] = random() % 2 ? uniform(random, low - 0.1, high + 0.1)
                            : t.position()[a] + uniform(random, -0.3, 0.3);
      }
      if (i % 50 == 0)
        t.start(x);
      else
        t.step(x);
      visited.insert(seen(t));
    }
    CHECK(std::includes(all.begin(), all.end(), visited.begin(), visited.end()));
    CHECK(visited.size() > all.size() / 3);
  }
}

TEST_CASE("the result does not depend on the number of threads") {
  const Grid grid = random_grid({{0, 0, 0}, 1, {5, 4, 6}}, 1, 2, 3);
  const CellMap one(grid, 1), three(grid, 3);
  const auto a = find_configurations(grid, one, 1, kNoLimit);
  const auto b = find_configurations(grid, three, 3, kNoLimit);
  CHECK(a.listed == b.listed);
  CHECK(a.listed.size() > 1000);
  const auto first = check_paths(grid, one, a, 1), second = check_paths(grid, three, b, 3);
  CHECK(checks_text(first, Details::kAll) == checks_text(second, Details::kAll));
  CHECK(checks_json(grid.box(), first) == checks_json(grid.box(), second));
}

TEST_CASE("too many configurations are given up, and that is no proof") {
  const Grid grid = random_grid({{0, 0, 0}, 1, {4, 4, 4}}, 1, 3, 3);
  const CellMap map(grid, 2);
  const auto found = find_configurations(grid, map, 2, 1000);
  CHECK(found.gave_up);
  const auto checks = check_paths(grid, map, found, 2);
  CHECK(checks[0].name == "paths");
  CHECK(checks[0].verdict() == "not proved");
  CHECK(verdict_line(checks) == "not proved: paths");
  CHECK_FALSE(is_fine(checks));
  CHECK_FALSE(is_broken(checks));
}

TEST_CASE("a grid that one can follow by hand") {
  // Three cells; in the ones at the ends play comes from the left (levels 0, 0 and 1, 0), the
  // right, or starts; a body that keeps its side is torn off at either end.
  const auto row = rows(tiny::grid());
  CHECK(row.at("paths").found.counted == 6);
  CHECK(row.at("paths").found.offenders == 0);
  // Along x corner 0 is the left one; the others repeat it along the flat axes.
  CHECK(tiny::texts(row.at("mixed").found) ==
        std::vector<std::string>{"cell (0, 0, 0) with levels 0 1 0 1 0 1 0 1",
                                 "cell (2, 0, 0) with levels 1 0 1 0 1 0 1 0"});
  // The states of a point that are taken for one another are +1 and -1.
  CHECK(figure(row.at("mixed"), "largest gap") == 2);
}

TEST_CASE("a missing link is found wherever play needs it") {
  std::mt19937_64 random(5);
  int needed = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Box box{{0, 0, 0}, 1, {4, 3, 3}};
    RecordColumns columns = random_columns(box, 1, trial % 2 ? 1 : 2, random());
    RecordColumns broken = columns;
    const auto r = random() % columns.size();
    const auto q = random() % kDirections;
    Level& link = broken.links[r * kDirections + q];
    if (link == kLeavesBox) continue;
    link = random() % 2 ? kUnsettled : Level{9};
    const Grid grid(spec_for(box, 1), 1, broken);
    const auto row = rows(grid, 2);
    const Oracle oracle(grid);
    const auto& found = row.at("paths").found;
    CHECK((found.offenders > 0) == (oracle.blocked > 0));
    CHECK(found.offenders == oracle.blocked);
    CHECK(found.counted == oracle.at.size());
    if (found.offenders == 0) continue;
    ++needed;
    const Grid whole(spec_for(box, 1), 1, columns);
    CHECK(rows(whole).at("paths").found.offenders == 0);
  }
  CHECK(needed > 10);
}

TEST_CASE("a lost level is a missing link") {
  auto records = tiny::records();
  // Level 1 of point 2, to which level 0 of point 1 leads.
  records.point.erase(records.point.begin() + 4);
  records.level.erase(records.level.begin() + 4);
  records.generation.erase(records.generation.begin() + 4);
  records.rows.erase(records.rows.begin() + 4);
  records.links.erase(records.links.begin() + 4 * kDirections,
                      records.links.begin() + 5 * kDirections);
  tiny::link(records, 1, tiny::kRight) = 1;
  const auto row = rows(Grid(tiny::spec(), tiny::kGeneration, records));
  CHECK(row.at("paths").found.offenders > 0);
  CHECK(row.at("paths").found.first[0].text.find(
            "needs point 1 (1, 0, 0) level 0 direction 13 (1, 0, 0)") != std::string::npos);
}

TEST_CASE("an incomplete grid leaves nothing to complain of here") {
  for (const Grid& grid : {tiny::after_one_round(), Grid(tiny::spec(), 0, {})})
    for (const auto& [name, check] : rows(grid))
      if (!check.is_note) CHECK(check.found.offenders == 0);
}
