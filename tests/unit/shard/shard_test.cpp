// What is written comes back, row by row; sections merge in order, whatever they are.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <fstream>
#include <utility>

#include "libcore/shard/load.hpp"
#include "libcore/shard/merged_rows.hpp"
#include "libcore/shard/reader.hpp"
#include "tests/unit/shard/rows.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;

namespace {

Row row_of(const RecordRows& rows, std::size_t r, std::uint32_t n) {
  Row row{rows.point[r], rows.level[r], rows.generation[r], {}, {}, 0};
  row.state.assign(rows.row(r), rows.row(r) + n);
  if (!rows.links.empty())
    row.links.assign(&rows.links[r * kDirections], &rows.links[r * kDirections] + kDirections);
  if (!rows.todo.empty()) row.todo = rows.todo[r];
  return row;
}
Row row_of(const RequestRows& rows, std::size_t r, std::uint32_t n) {
  Row row{rows.point[r], rows.level[r], 0, {}, {}, rows.directions[r]};
  const auto count = static_cast<std::size_t>(std::popcount(rows.directions[r]));
  row.state.assign(rows.row(rows.first[r]), rows.row(rows.first[r]) + count * n);
  return row;
}

template <class Rows>
std::vector<Row> read_section(const Section& section) {
  std::vector<Row> found;
  SectionReader reader(section);
  for (Rows rows; reader.next(rows);)
    for (std::size_t r = 0; r < rows.size(); ++r)
      found.push_back(row_of(rows, r, row_size(section.header)));
  return found;
}

template <class Rows>
std::vector<Row> read_merged(const std::vector<Section>& sections) {
  std::vector<Row> found;
  MergedRows<Rows> merged(sections);
  for (Run<Rows> run = merged.next(); run.rows; run = merged.next()) {
    REQUIRE(run.begin < run.end);
    REQUIRE(run.end <= run.rows->size());
    for (std::size_t r = run.begin; r < run.end; ++r)
      found.push_back(row_of(*run.rows, r, row_size(sections.front().header)));
  }
  return found;
}

std::vector<Row> read_any(const std::vector<Section>& sections, bool merged) {
  if (sections.front().header.content == Content::kRequests)
    return merged ? read_merged<RequestRows>(sections) : read_section<RequestRows>(sections[0]);
  return merged ? read_merged<RecordRows>(sections) : read_section<RecordRows>(sections[0]);
}

constexpr Content kContents[] = {Content::kGrid, Content::kFrontier, Content::kRequests};

}  // namespace

TEST_CASE("rows come back from a shard as they were") {
  Random random(2003);
  bool first = true;  // once a coded grid, once a plain one
  for (const Content content :
       {Content::kGrid, Content::kGrid, Content::kFrontier, Content::kRequests}) {
    const bool coded = content == Content::kGrid && std::exchange(first, false);
    for (const std::uint32_t n : {1u, 2u, 1500u}) {
      // Nothing, one row, and several chunks.
      for (const std::size_t wanted :
           {std::size_t{0}, std::size_t{1}, n == 1500 ? std::size_t{300} : 150000}) {
        CAPTURE(to_string(content), coded, n, wanted);
        const TemporaryDirectory dir;
        GridSpec spec = make_spec(n, {60, 50, 20});
        if (n == 2) spec = storing(spec);
        const SectionHeader header{content, 7, spec, {coded, 0, {}}};
        const std::vector<Row> rows = random_rows(random, header, wanted);
        write(dir.file("shard"), header, rows);
        const auto sections = open_sections({dir.file("shard")});
        REQUIRE(sections.size() == 1);
        const Section& section = sections[0];
        REQUIRE(section.header.content == content);
        REQUIRE(section.header.generation == 7);
        REQUIRE(section.header.spec == header.spec);
        std::uint64_t requests = 0;
        for (const Row& row : rows) requests += row.state.size() / row_size(header);
        const bool of_requests = content == Content::kRequests;
        REQUIRE(section.footer.records == (of_requests ? 0 : rows.size()));
        REQUIRE(section.footer.requests == (of_requests ? requests : 0));
        REQUIRE(section.footer.chunks.size() >=
                (wanted > 1 && !coded ? 2 : std::min<std::size_t>(wanted, 1)));
        REQUIRE(read_any(sections, false) == rows);
        REQUIRE(read_any(sections, true) == rows);
        // The same rows are the same bytes.
        write(dir.file("again"), header, rows);
        std::ifstream a(dir.file("shard"), std::ios::binary);
        std::ifstream b(dir.file("again"), std::ios::binary);
        REQUIRE(std::equal(std::istreambuf_iterator<char>(a), {}, std::istreambuf_iterator<char>(b),
                           {}));
      }
    }
  }
}

TEST_CASE("chunks of a grid stay below 64 KiB") {
  Random random(2004);
  for (const std::uint32_t n : {1u, 9u, 1500u, 200000u}) {
    CAPTURE(n);
    const TemporaryDirectory dir;
    const SectionHeader header{Content::kGrid, 0, make_spec(n, {40, 40, 40})};
    std::vector<Row> rows = random_rows(random, header, n > 1500 ? 5 : n > 9 ? 1000 : 40000);
    write(dir.file("shard"), header, rows);
    const auto sections = open_sections({dir.file("shard")});
    for (const ChunkInfo& chunk : sections[0].footer.chunks) {
      const std::uint64_t bytes = chunk.rows * record_bytes(n);
      REQUIRE((chunk.rows == 1 || bytes <= 64 << 10));
    }
    REQUIRE(read_any(sections, false) == rows);
  }
}

TEST_CASE("sections merge in order, whatever they are and wherever they come from") {
  Random random(2005);
  for (int i = 0; i < 150; ++i) {
    CAPTURE(i);
    const TemporaryDirectory dir;
    const Content content = kContents[i % 3];
    SectionHeader header{content, 2,
                         make_spec(draw(random, 1, 3),
                                   {draw(random, 1, 30), draw(random, 1, 9), draw(random, 1, 9)})};
    if (i % 2) header.spec = storing(header.spec);
    const std::vector<Row> rows = random_rows(random, header, i % 10 ? draw(random, 0, 60) : 30000);
    // Each row goes to one section or to several of them: equal keys, one after the other.
    const std::uint32_t count = draw(random, 1, 6);
    std::vector<std::vector<Row>> sections(count);
    std::vector<Row> expected;
    const bool slices = random() % 2;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const std::size_t home = slices ? r * count / rows.size() : draw(random, 0, count - 1);
      sections[home].push_back(rows[r]);
      expected.push_back(rows[r]);
      for (std::size_t s = 0; s < count; ++s) {
        if (s == home || random() % 5 != 0) continue;
        sections[s].push_back(rows[r]);
        expected.push_back(rows[r]);
      }
    }
    // In random order over some files.
    std::shuffle(sections.begin(), sections.end(), random);
    std::vector<std::string> names;
    for (const auto& section : sections) {
      if (names.empty() || random() % 2) names.push_back(dir.file(std::to_string(names.size())));
      write(names.back(), header, section);
    }
    std::shuffle(names.begin(), names.end(), random);
    const std::vector<Section> opened = open_sections(names);
    REQUIRE(opened.size() == count);
    REQUIRE(read_any(opened, true) == expected);
  }
}

TEST_CASE("load_grid() holds what was written, from any number of shards") {
  Random random(2007);
  const TemporaryDirectory dir;
  const SectionHeader header{Content::kGrid, 5, make_spec(3, {13, 11, 7})};
  const Neighbourhood neighbourhood(header.spec.box);
  std::vector<Row> rows;
  for (PointIndex p = 0; p < header.spec.box.points(); ++p) {
    const std::uint32_t levels = draw(random, 0, 3);
    for (Level l = 0; l < levels; ++l) {
      Row row{p, l, draw(random, 0, 5), random_state(random, 3), {}, 0};
      for (int q = 0; q < kDirections; ++q)
        row.links.push_back(neighbourhood.inside(p) >> q & 1 ? Level{0} : kLeavesBox);
      rows.push_back(row);
    }
  }
  std::vector<Row> parts[3];
  for (std::size_t r = 0; r < rows.size(); ++r) parts[random() % 3].push_back(rows[r]);
  for (int k = 0; k < 3; ++k) write(dir.file(std::to_string(k)), header, parts[k]);
  const LoadedGrid loaded = load_grid({dir.file("2"), dir.file("0"), dir.file("1")});
  const Grid& grid = loaded.grid;
  REQUIRE(grid.records() == rows.size());
  REQUIRE(loaded.stored_bytes == std::filesystem::file_size(dir.file("0")) +
                                     std::filesystem::file_size(dir.file("1")) +
                                     std::filesystem::file_size(dir.file("2")));
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    REQUIRE(grid.point(r) == rows[r].point);
    REQUIRE(grid.level(r) == rows[r].level);
    REQUIRE(grid.record_generation(r) == rows[r].generation);
    REQUIRE(std::equal(grid.state(r).begin(), grid.state(r).end(), rows[r].state.begin()));
    REQUIRE(std::equal(grid.links(r).begin(), grid.links(r).end(), rows[r].links.begin()));
    for (int q = 0; q < kDirections; ++q) {
      const RecordIndex to = grid.destination(r, q);
      const auto target = static_cast<std::uint64_t>(rows[r].point + neighbourhood.offset(q));
      const bool there = rows[r].links[static_cast<std::size_t>(q)] == 0 &&
                         std::any_of(rows.begin(), rows.end(),
                                     [&](const Row& row) { return row.point == target; });
      REQUIRE((to != Grid::kNoRecord) == there);
      if (there) REQUIRE((grid.point(to) == target && grid.level(to) == 0));
    }
  }
}
