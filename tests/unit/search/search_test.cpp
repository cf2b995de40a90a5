// The search against the paper's Algorithm 1, written down line by line in reference.hpp.
#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>

#include "libcore/search/requests.hpp"
#include "tests/unit/search/shards.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;

TEST_CASE("rounds of expand and merge are Algorithm 1, generation by generation") {
  Random random(20031);
  std::size_t most_levels = 0;
  for (int i = 0; i < 120; ++i) {
    CAPTURE(i);
    const TemporaryDirectory dir;
    Case c(random);
    if (i % 20 == 0) c.resize({16, 16, 20});  // several chunks
    reference::Search search = c.search();
    std::string grid = dir.file("grid");
    write_seed_shard(c, grid);
    require_same(grid, search);
    int round = 0;
    for (bool more = true; more; ++round) {
      // The generation in parts, merged in any order, and some of the requests twice.
      const int parts = draw(random, 1, 4);
      std::vector<std::string> inputs{grid};
      for (int k = 1; k <= parts; ++k) {
        inputs.push_back(dir.file("requests" + std::to_string(k)));
        expand_shard(grid, {static_cast<std::uint64_t>(k), static_cast<std::uint64_t>(parts)},
                     inputs.back());
      }
      if (draw(random, 0, 2) == 0) inputs.push_back(inputs.back());
      if (draw(random, 0, 2) == 0) {
        inputs.push_back(dir.file("other-parts"));
        expand_shard(grid, {2, 3}, inputs.back());
      }
      std::shuffle(inputs.begin(), inputs.end(), random);
      grid = dir.file("grid" + std::to_string(round));
      merge_shards(inputs, grid);
      more = search.round();
      require_same(grid, search);
    }
    for (const auto& [key, record] : search.x())
      most_levels = std::max(most_levels, std::size_t(key.second) + 1);
    // The chunks that were copied from round to round are those of a search in memory.
    complete_shard(dir.file("grid"), dir.file("complete"), 2);
    REQUIRE(load_grid(grid).digest == load_grid(dir.file("complete")).digest);
  }
  // Else the order of requests was not put to the test.
  REQUIRE(most_levels >= 4);
}

TEST_CASE("complete() is Algorithm 1, with any number of threads") {
  Random random(20032);
  for (int i = 0; i < 100; ++i) {
    CAPTURE(i);
    const TemporaryDirectory dir;
    const Case c(random, i % 10 ? 6 : 10);
    reference::Search search = c.search();
    write_seed_shard(c, dir.file("seeds"));
    // From the seeds, or from a generation on the way.
    if (draw(random, 0, 1)) {
      for (int g = draw(random, 1, 3); g > 0 && search.round(); --g) {
        expand_shard(dir.file("seeds"), {}, dir.file("requests"));
        merge_shards({dir.file("seeds"), dir.file("requests")}, dir.file("next"));
        move_file(dir.file("next"), dir.file("seeds"));
      }
    }
    complete_shard(dir.file("seeds"), dir.file("grid"), static_cast<unsigned>(draw(random, 1, 4)));
    while (search.round()) {
    }
    require_same(dir.file("grid"), search);
  }
}

TEST_CASE("expand's requests are the queue, and its parts cut it without overlap") {
  Random random(20033);
  for (int i = 0; i < 60; ++i) {
    CAPTURE(i);
    const TemporaryDirectory dir;
    Case c(random);
    const bool large = i % 10 == 0;  // chunks that lie wholly before a part are passed over
    if (large) c.resize({16, 16, 20});
    reference::Search search = c.search();
    const std::string grid = dir.file("grid");
    write_seed_shard(c, grid);
    for (int g = draw(random, 0, large ? 12 : 4); g > 0 && search.round(); --g) {
      expand_shard(grid, {}, dir.file("requests"));
      merge_shards({grid, dir.file("requests")}, dir.file("next"));
      move_file(dir.file("next"), grid);
    }
    using Row = std::tuple<std::uint64_t, int, int, std::uint64_t, std::vector<double>>;
    std::vector<Row> expected;
    for (const reference::Request& r : search.queue())
      expected.emplace_back(r.source, r.level, r.q, r.target, r.s);
    std::sort(expected.begin(), expected.end());

    const auto parts = static_cast<std::uint64_t>(draw(random, 1, 9));
    std::vector<Row> found;
    for (std::uint64_t k = 1; k <= parts; ++k) {
      expand_shard(grid, {k, parts}, dir.file("part"));
      const auto sections = open_sections({dir.file("part")});
      const Neighbourhood neighbourhood(sections.front().header.spec.box);
      RequestReader requests(sections);
      SourceRequests source;
      while (requests.next(source))
        for (int q = 0; q < kDirections; ++q)
          if (source.directions >> q & 1)
            found.emplace_back(source.point, source.level, q,
                               static_cast<std::uint64_t>(source.point + neighbourhood.offset(q)),
                               std::vector<double>(source.row(q), source.row(q) + source.width));
    }
    std::sort(found.begin(), found.end());
    // Together the parts are the queue.
    REQUIRE(found == expected);
  }
}

TEST_CASE("threads share the directions of a record") {
  Random random(20037);
  Case c(random, 3);
  while (c.grid.counts != std::array{3, 3, 3}) c = Case(random, 3);
  SeedDefinition centre;
  for (int a = 0; a < 3; ++a) centre.position[a] = c.grid.origin[a] + c.grid.spacing;
  c.definition.seeds = {centre};
  c.definition.parameters.insert(c.definition.parameters.begin() + 1, {"milliseconds", 50.0});
  const TemporaryDirectory dir;
  write_seed_shard(c, dir.file("seeds"));
  const auto start = std::chrono::steady_clock::now();
  expand_shard(dir.file("seeds"), {}, dir.file("requests"), 13);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  // Two pauses a thread; one thread would make 26 of them.
  CHECK(time.count() > 2 * 0.05);
  CHECK(time.count() < 26 * 0.05);
}
