// Faults planted into the switch rule itself. libcore/grid/cell.hpp has it as a constant; here the
// check's sources are compiled with a copy of that header in which it can be changed
// (CMakeLists.txt).
#include <array>
#include <catch2/catch.hpp>
#include <functional>
#include <random>

#include "libcore/check/configurations.hpp"
#include "libcore/check/paths.hpp"
#include "tests/unit/haptic/random_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

constexpr auto kRight = cell_detail::cell_switches();

/// Every kind of switch is there, every point has two levels, and a link in four leads to the other
/// one: the corners' links hardly ever agree, so what a rule takes from where it shows.
Grid grid() {
  std::mt19937_64 random(1);
  const Box box{{0, 0, 0}, 1, {3, 3, 3}};
  const Neighbourhood around(box);
  RecordColumns columns;
  for (PointIndex p = 0; p < box.points(); ++p)
    for (Level l = 0; l < 2; ++l) {
      columns.point.push_back(p);
      columns.level.push_back(l);
      columns.generation.push_back(0);
      columns.rows.push_back(l);
      for (int q = 0; q < kDirections; ++q)
        columns.links.push_back(around.inside(p) >> q & 1
                                    ? static_cast<Level>(random() % 4 == 0 ? 1 - l : l)
                                    : kLeavesBox);
    }
  return Grid(spec_for(box, 1), 1, columns);
}

struct Offenders {
  std::uint64_t paths, continuous;
};

Offenders look_at(const Grid& grid) {
  const CellMap map(grid, 1);
  const auto checks = check_paths(
      grid, map, find_configurations(grid, map, 1, default_configuration_limit(map)), 1);
  REQUIRE(checks.at(0).name == "paths");
  REQUIRE(checks.at(1).name == "continuous");
  return {checks[0].found.offenders, checks[1].found.offenders};
}

/// Where a corner is, seen from the old cell's corner (0,0,0): of the new cell the move away.
std::array<int, 3> place(int corner, const std::array<int, 3>& move) {
  return {(corner & 1) + move[0], (corner >> 1 & 1) + move[1], (corner >> 2) + move[2]};
}

/// Calls look(q, corner) with each entry of the rule, which look() may change.
void for_each_entry(const std::function<void(int, int)>& look) {
  for (int q = 0; q < kDirections; ++q)
    for (int corner = 0; corner < 8; ++corner) {
      look(q, corner);
      kCellSwitches = kRight;
    }
}

bool is_kept(int q, int corner) { return kRight[q].direction[corner] == CellSwitch::kKept; }

/// Calls look() with the corner converted from each other old corner than the rule says from where
/// one direction leads there.
void for_each_other_source(int q, int corner, const std::function<void()>& look) {
  const auto to = place(corner, Direction(q).step());
  for (int from = 0; from < 8; ++from) {
    if (from == kRight[q].from[corner]) continue;
    const auto at = place(from, {0, 0, 0});
    std::array<int, 3> d;
    bool is_step = true;
    for (int a = 0; a < 3; ++a) is_step &= std::abs(d[a] = to[a] - at[a]) <= 1;
    if (!is_step || d == std::array<int, 3>{0, 0, 0}) continue;
    kCellSwitches[q].from[corner] = static_cast<std::uint8_t>(from);
    kCellSwitches[q].direction[corner] =
        static_cast<std::uint8_t>(Direction::of(d[0], d[1], d[2]).q());
    look();
  }
}

}  // namespace

TEST_CASE("the rule as it is keeps the common vertices") {
  const Offenders found = look_at(grid());
  CHECK(found.paths == 0);
  CHECK(found.continuous == 0);
}

TEST_CASE("a common vertex that takes another corner's record is found") {
  const Grid g = grid();
  int planted = 0;
  for_each_entry([&](int q, int corner) {
    if (!is_kept(q, corner)) return;
    for (int from = 0; from < 8; ++from) {
      if (from == kRight[q].from[corner]) continue;
      kCellSwitches[q].from[corner] = static_cast<std::uint8_t>(from);
      CAPTURE(q, corner, from);
      CHECK(look_at(g).continuous > 0);
      ++planted;
    }
  });
  CHECK(planted == (6 * 4 + 12 * 2 + 8 * 1) * 7);  // across faces, edges, vertices
}

TEST_CASE("a common vertex that is converted, instead of kept, is found") {
  const Grid g = grid();
  int planted = 0;
  for_each_entry([&](int q, int corner) {
    if (!is_kept(q, corner)) return;
    for_each_other_source(q, corner, [&] {
      CAPTURE(q, corner);
      CHECK(look_at(g).continuous > 0);
      ++planted;
    });
  });
  CHECK(planted == (6 * 4 + 12 * 2 + 8 * 1) * 7);
}

TEST_CASE("a new vertex that keeps an old corner's record is found") {
  const Grid g = grid();
  for_each_entry([&](int q, int corner) {
    if (is_kept(q, corner)) return;
    kCellSwitches[q].direction[corner] = CellSwitch::kKept;
    CAPTURE(q, corner);
    CHECK(look_at(g).continuous > 0);
  });
}

TEST_CASE("the rule of another move is found") {
  const Grid g = grid();
  for (int q = 0; q < kDirections; ++q)
    for (int other = 0; other < q; ++other) {
      std::swap(kCellSwitches[q], kCellSwitches[other]);
      CAPTURE(q, other);
      // Many lead out of the box first.
      const Offenders found = look_at(g);
      CHECK(found.continuous + found.paths > 0);
      kCellSwitches = kRight;
    }
}

TEST_CASE("a new vertex that is converted from another old corner leaves play continuous") {
  // It plays by another rule, and nothing jumps: that it is the paper's is what the tests of the
  // traversal say (unit/haptic/levels_test.cpp).
  const Grid g = grid();
  int planted = 0;
  for_each_entry([&](int q, int corner) {
    if (is_kept(q, corner)) return;
    for_each_other_source(q, corner, [&] {
      CAPTURE(q, corner);
      const Offenders found = look_at(g);
      CHECK(found.continuous == 0);
      CHECK(found.paths == 0);
      ++planted;
    });
  });
  CHECK(planted > 300);
}
