// A frontier as FrontierReader reads it, dealt out to parts.
#include "libcore/search/frontier.hpp"

#include <catch2/catch.hpp>
#include <map>
#include <tuple>
#include <vector>

#include "tests/unit/shard/rows.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;

TEST_CASE("parts cover each conversion of a frontier exactly once") {
  Random random(2006);
  for (int i = 0; i < 200; ++i) {
    CAPTURE(i);
    const TemporaryDirectory dir;
    // Large states make many chunks.
    const bool large = i % 10 == 3;
    const std::uint32_t n = large ? 3000 : 2;
    const SectionHeader header{
        Content::kGrid, 3,
        make_spec(n, {draw(random, 1, 7), draw(random, 1, 7), draw(random, 1, 7)})};
    const Neighbourhood neighbourhood(header.spec.box);
    const std::vector<Row> rows = random_rows(random, header, draw(random, 0, large ? 300 : 80));
    std::map<std::tuple<PointIndex, Level, int>, int> asked;
    std::map<RowKey, std::vector<double>> states;
    for (const Row& row : rows) {
      if (row.generation != 3) continue;
      const DirectionMask inside = neighbourhood.inside(row.point);
      for (int q = 0; q < kDirections; ++q)
        if (inside >> q & 1) asked[{row.point, row.level, q}] = 0;
      states[record_key(row.point, row.level)] = row.state;
    }
    write(dir.file("grid"), header, rows);
    const Section grid = open_grid(dir.file("grid"));
    // Now and then more parts than conversions.
    const std::uint64_t parts = draw(random, 1, large ? 3 : i % 10 ? 12 : 2000);
    for (std::uint64_t k = 1; k <= parts; ++k) {
      FrontierReader reader(grid, Part{k, parts});
      std::uint64_t found = 0;
      FrontierRecord record;
      RowKey last = 0;
      for (bool first = true; reader.next(record); first = false) {
        const RowKey key = record_key(record.point, record.level);
        REQUIRE((first || key > last));
        last = key;
        REQUIRE(record.todo != 0);
        REQUIRE(std::vector<double>(record.state, record.state + n) == states.at(key));
        for (int q = 0; q < kDirections; ++q) {
          if (!(record.todo >> q & 1)) continue;
          ++asked.at({record.point, record.level, q});
          ++found;
        }
      }
      REQUIRE(found == reader.conversions());
    }
    for (const auto& [conversion, times] : asked) REQUIRE(times == 1);
  }
}

TEST_CASE("blocks of a frontier are dealt out in turns, and parts differ by one of them at most") {
  Random random(2007);
  for (int i = 0; i < 300; ++i) {
    const std::uint64_t total = random() % (i % 2 ? 100000 : 100);
    const std::uint64_t parts = draw(random, 1, i % 3 ? 9 : 300);
    CAPTURE(total, parts);
    std::uint64_t sum = 0, least = ~std::uint64_t{0}, most = 0;
    for (std::uint64_t k = 1; k <= parts; ++k) {
      const Partition part(total, {k, parts});
      std::uint64_t mine = 0;
      for (std::uint64_t c = 0; c < total; ++c) mine += part.mine(1, c);
      REQUIRE(mine == part.size());
      REQUIRE(part.has_any(0, total) == (mine > 0));
      sum += mine;
      least = std::min(least, mine);
      most = std::max(most, mine);
    }
    REQUIRE(sum == total);
    // Turns of a block each, and what is left of a turn.
    const std::uint64_t block = std::max<std::uint64_t>(total / parts / 512, 1);
    REQUIRE(most - least <=
            (total / parts / 32 >= 1024 ? std::max<std::uint64_t>(block, 1024) : block));
  }
  // Numbers near the limits of a grid and of N.
  const Partition last(std::uint64_t{1} << 45, {0xffffffff, 0xffffffff});
  REQUIRE(last.size() <= (std::uint64_t{1} << 14));
}
