// A frontier as FrontierReader reads it, from grids and from shards of its own.
#include "libcore/search/frontier.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "libcore/base/error.hpp"
#include "tests/unit/shard/rows.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;

TEST_CASE("a frontier is cut into parts that cover each conversion exactly once") {
  Random random(2006);
  for (int i = 0; i < 200; ++i) {
    CAPTURE(i);
    const TemporaryDirectory dir;
    const Content content = i % 2 ? Content::kGrid : Content::kFrontier;
    const SectionHeader header{
        content, 3, make_spec(2, {draw(random, 1, 7), draw(random, 1, 7), draw(random, 1, 7)})};
    const Neighbourhood neighbourhood(header.spec.box);
    const std::vector<Row> rows = random_rows(random, header, draw(random, 0, 80));
    // Frontier shards may share a record, each with its own directions.
    std::vector<Row> halves[2];
    std::map<std::tuple<PointIndex, Level, int>, int> asked;
    std::map<RowKey, std::vector<double>> states;
    for (const Row& row : rows) {
      if (row.generation != 3) {
        halves[0].push_back(row);
        continue;
      }
      const DirectionMask todo =
          content == Content::kGrid ? neighbourhood.inside(row.point) : row.todo;
      for (int q = 0; q < kDirections; ++q)
        if (todo >> q & 1) asked[{row.point, row.level, q}] = 0;
      states[record_key(row.point, row.level)] = row.state;
      Row half[2] = {row, row};
      if (content == Content::kFrontier) {
        half[0].todo &= static_cast<DirectionMask>(random());
        half[1].todo &= ~half[0].todo;
        halves[1].push_back(half[1]);
      }
      halves[0].push_back(half[0]);
    }
    write(dir.file("a"), header, halves[0]);
    write(dir.file("b"), header, halves[1]);
    const auto sections = open_sections({dir.file("b"), dir.file("a")});
    const std::uint64_t parts = draw(random, 1, 12);
    for (std::uint64_t k = 1; k <= parts; ++k) {
      FrontierReader reader(sections, Part{k, parts});
      std::uint64_t found = 0;
      FrontierReader::Record record;
      RowKey last = 0;
      for (bool first = true; reader.next(record); first = false) {
        const RowKey key = record_key(record.point, record.level);
        REQUIRE((first || key > last));
        last = key;
        REQUIRE(record.todo != 0);
        REQUIRE(std::vector<double>(record.state, record.state + 2) == states.at(key));
        for (int q = 0; q < kDirections; ++q) {
          if (!(record.todo >> q & 1)) continue;
          ++asked.at({record.point, record.level, q});
          ++found;
        }
      }
      REQUIRE(found == reader.conversions());
      REQUIRE(std::abs(double(found) - double(asked.size()) / double(parts)) < 1);
    }
    for (const auto& [conversion, times] : asked) REQUIRE(times == 1);
  }
}

TEST_CASE("a frontier's record with two states is refused") {
  const TemporaryDirectory dir;
  const SectionHeader header{Content::kFrontier, 3, make_spec(1, {3, 3, 3})};
  write(dir.file("a"), header, {{4, 0, 3, {0.5}, {}, 1u << 25}});
  write(dir.file("b"), header, {{4, 0, 3, {0.25}, {}, 1u << 25}});
  const auto sections = open_sections({dir.file("a"), dir.file("b")});
  FrontierReader reader(sections);
  FrontierReader::Record record;
  REQUIRE_THROWS_AS(reader.next(record), FormatError);
}
