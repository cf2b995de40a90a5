// The search against the paper's Algorithm 1, written down line by line in reference.hpp.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <chrono>

#include "libcore/base/error.hpp"
#include "tests/unit/search/shards.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;

TEST_CASE("rounds of expand and merge are Algorithm 1, generation by generation") {
  Random random(20031);
  std::size_t most_levels = 0;
  for (int i = 0; i < 120; ++i) {
    CAPTURE(i);
    const TemporaryDirectory dir;
    const Case c(random);
    reference::Search search = c.search();
    std::vector<std::string> grid{dir.file("grid")};  // in one shard, or in layers and a tip
    write_seed_shard(c, grid.front());
    require_same(grid, search);
    std::vector<std::string> frontier;  // of generation 0 there are no frontier shards
    int round = 0;
    for (bool more = true; more; ++round) {
      // The generation in parts, from the grid or from frontier shards; merged in any order, and
      // some of the requests twice.
      const int parts = draw(random, 1, 4);
      const bool from_frontier = !frontier.empty() && draw(random, 0, 1);
      std::vector<std::string> inputs = grid;
      for (int k = 1; k <= parts; ++k) {
        inputs.push_back(dir.file("requests" + std::to_string(k)));
        expand_shards(from_frontier ? frontier : grid,
                      {static_cast<std::uint64_t>(k), static_cast<std::uint64_t>(parts)},
                      inputs.back());
      }
      if (draw(random, 0, 2) == 0) inputs.push_back(inputs.back());
      std::shuffle(inputs.begin(), inputs.end(), random);
      const std::string next = dir.file("grid" + std::to_string(round));
      frontier = {dir.file("frontier")};
      const bool apart = grid.size() > 1 || round == 0;
      switch (draw(random, 1, apart ? 6 : 2)) {
        case 1:
          merge_shards(inputs, next, frontier.front());
          grid = {next};
          break;
        case 2:
          merge_shards(inputs, next, frontier.front(), next + ".tip");
          grid = {next, next + ".tip"};
          break;
        default:
          merge_shards(inputs, next, frontier.front(), next + ".tip", /*layer=*/true);
          // What had a frontier is in the layer now.
          std::erase_if(grid, [](const std::string& name) {
            return open_sections({name}).front().footer.frontier > 0;
          });
          grid.push_back(next);
          grid.push_back(next + ".tip");
      }
      more = search.round();
      require_same(grid, search);
    }
    for (const auto& [key, record] : search.x())
      most_levels = std::max(most_levels, std::size_t(key.second) + 1);
  }
  // Else the order of requests was not put to the test.
  REQUIRE(most_levels >= 4);
}

// A merge reads old layers only in the blocks of points where second levels need them: here there
// are several, and the reference looks at every level of every target.
TEST_CASE("layers of a grid of several blocks are Algorithm 1") {
  Random random(20037);
  const std::array<int, 3> sizes[] = {{16, 16, 20}, {40, 12, 10}, {7, 11, 60}};
  for (int i = 0; i < 6; ++i) {
    CAPTURE(i);
    const std::array<int, 3>& counts = sizes[i % 3];
    const TemporaryDirectory dir;
    Case c(random);
    while (c.toy.state_size != 1 || c.toy.amplitude > 0.3 || c.seeds.size() < 2) c = Case(random);
    // Second levels that end at once are in recent layers where no other second level is.
    if (i >= 3)
      c.set_model({.salt = c.toy.salt, .amplitude = 0.1, .tolerance = 0.15, .memory = 0.25});
    c.resize(counts);
    reference::Search search = c.search();
    std::vector<std::string> layers;
    std::string tip = dir.file("tip0");
    write_seed_shard(c, tip);
    for (int round = 1; layers.empty() || open_sections({tip}).front().footer.frontier > 0;
         ++round) {
      expand_shards({tip}, {}, dir.file("requests"));
      std::vector<std::string> inputs = layers;
      inputs.push_back(tip);
      inputs.push_back(dir.file("requests"));
      layers.push_back(dir.file("layer" + std::to_string(round)));
      tip = dir.file("tip" + std::to_string(round));
      merge_shards(inputs, layers.back(), "", tip, /*layer=*/true);
      search.round();
    }
    std::vector<std::string> all = layers;
    all.push_back(tip);
    require_same(all, search);
    // Else no old layer was needed.
    REQUIRE(std::any_of(search.x().begin(), search.x().end(),
                        [](const auto& record) { return record.first.second > 0; }));
    // As one shard, which is the one that a search in memory writes.
    merge_shards(all, dir.file("joined"));
    complete_shard(dir.file("tip0"), dir.file("complete"), 2);
    REQUIRE(load_grid({dir.file("joined")}).digest == load_grid({dir.file("complete")}).digest);
  }
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
        expand_shards({dir.file("seeds")}, {}, dir.file("requests"));
        merge_shards({dir.file("seeds"), dir.file("requests")}, dir.file("next"));
        move_file(dir.file("next"), dir.file("seeds"));
      }
    }
    complete_shard(dir.file("seeds"), dir.file("grid"), static_cast<unsigned>(draw(random, 1, 4)));
    while (search.round()) {
    }
    require_same({dir.file("grid")}, search);
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
      expand_shards({grid}, {}, dir.file("requests"));
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
      expand_shards({grid}, {k, parts}, dir.file("part"));
      const auto sections = open_sections({dir.file("part")});
      const std::uint32_t n = sections.front().header.spec.state_size;
      const Neighbourhood neighbourhood(sections.front().header.spec.box);
      MergedRows<RequestRows> rows(sections);
      const std::size_t before = found.size();
      for (auto run = rows.next(); run.rows; run = rows.next())
        for (std::size_t r = run.begin; r < run.end; ++r) {
          const PointIndex point = run.rows->point[r];
          const double* s = run.rows->row(run.rows->first[r]);
          for (int q = 0; q < kDirections; ++q) {
            if (!(run.rows->directions[r] >> q & 1)) continue;
            found.emplace_back(point, run.rows->level[r], q,
                               static_cast<std::uint64_t>(point + neighbourhood.offset(q)),
                               std::vector<double>(s, s + n));
            s += n;
          }
        }
      // Equal parts.
      const double share = double(expected.size()) / double(parts);
      REQUIRE(std::abs(double(found.size() - before) - share) < 1);
    }
    // The parts one after the other are the queue in its order.
    REQUIRE(found == expected);
  }
}

TEST_CASE("the level limit stops a model that is not finite") {
  Random random(20034);
  Case c(random);
  while (c.toy.state_size != 2 || c.toy.tolerance > 0.2 || c.grid.counts < std::array{5, 5, 5})
    c = Case(random);
  c.definition.max_levels = 3;
  const TemporaryDirectory dir;
  write_seed_shard(c, dir.file("seeds"));
  REQUIRE_THROWS_WITH(complete_shard(dir.file("seeds"), dir.file("grid"), 1),
                      Catch::Matchers::Matches(
                          "level limit: point [0-9]+ \\([0-9]+, [0-9]+, [0-9]+\\) has 3 levels "
                          "\\(search\\.max_levels\\), .* within the tolerance 0\\.2 turns: .*"));
}

TEST_CASE("merge counts the requests that are missing, and refuses those nobody asked for") {
  Random random(20035);
  Case c(random);
  while (c.grid.counts < std::array{4, 4, 4} || c.seeds.size() < 2) c = Case(random);
  const TemporaryDirectory dir;
  const std::string grid = dir.file("grid");
  write_seed_shard(c, grid);
  for (std::uint64_t k = 1; k <= 3; ++k)
    expand_shards({grid}, {k, 3}, dir.file("r" + std::to_string(k)));
  const auto count = [&](const std::string& name) {
    return open_sections({dir.file(name)}).front().footer.requests;
  };
  const std::uint64_t missing = count("r2");
  const std::uint64_t all = missing + count("r1") + count("r3");
  REQUIRE_THROWS_WITH(
      merge_shards({grid, dir.file("r1"), dir.file("r3")}, dir.file("next")),
      Catch::Matchers::StartsWith("requests are missing: " + std::to_string(missing) + " of the " +
                                  std::to_string(all) + " conversions of generation 0, the first"));
  REQUIRE_THROWS_WITH(merge_shards({grid}, dir.file("next")),
                      Catch::Matchers::StartsWith("requests are missing: " + std::to_string(all) +
                                                  " of the " + std::to_string(all)));

  // The same requests, one of them with another state: before or behind the right one.
  const auto sections = open_sections({dir.file("r1")});
  const std::uint32_t n = sections.front().header.spec.state_size;
  write_shard(dir.file("wrong"), sections.front().header, [&](SectionWriter& out) {
    MergedRows<RequestRows> rows(sections);
    const auto run = rows.next();
    const DirectionMask directions = run.rows->directions[0];
    const DirectionMask one = directions & (0 - directions);
    std::vector<double> reached(std::size_t{kDirections} * n);
    const auto q = static_cast<std::size_t>(std::countr_zero(one));
    std::copy_n(run.rows->row(0), n, &reached[q * n]);
    reached[q * n] += 1e-9;
    out.requests(run.rows->point[0], run.rows->level[0], one, reached.data());
    out.finish();
  });
  const std::vector<std::string> right{grid, dir.file("r1"), dir.file("r2"), dir.file("r3")};
  std::vector<std::string> names = right;
  names.push_back(dir.file("wrong"));
  for (int i = 0; i < 2; ++i) {
    REQUIRE_THROWS_WITH(merge_shards(names, dir.file("next")),
                        Catch::Matchers::EndsWith(": two different answers"));
    std::reverse(names.begin(), names.end());
  }

  merge_shards(right, dir.file("next"));
  REQUIRE_THROWS_WITH(
      merge_shards({dir.file("next"), dir.file("r1")}, dir.file("x")),
      Catch::Matchers::Contains("requests of generation 0, the grid's frontier is 1"));
  // The right generation, but a conversion that no record asks for.
  SectionHeader header = sections.front().header;
  header.generation = 1;
  write_shard(dir.file("unasked"), header, [&](SectionWriter& out) {
    const std::vector<double> reached(std::size_t{kDirections} * n, 0.5);
    out.requests(0, 200, DirectionMask{1} << Direction::of(1, 1, 1).q(), reached.data());
    out.finish();
  });
  REQUIRE_THROWS_WITH(merge_shards({dir.file("next"), dir.file("unasked")}, dir.file("x")),
                      Catch::Matchers::EndsWith("the grid's frontier asks for no such conversion"));
}

TEST_CASE("a conversion that fails is named, the same with any number of threads") {
  Random random(20036);
  Case c(random);
  while (c.grid.counts < std::array{5, 5, 5}) c = Case(random);
  c.definition.parameters.push_back({"fail", c.grid.origin[0] + 2 * c.grid.spacing});
  std::sort(c.definition.parameters.begin(), c.definition.parameters.end(),
            [](const Parameter& a, const Parameter& b) { return a.key < b.key; });
  const TemporaryDirectory dir;
  write_seed_shard(c, dir.file("seeds"));
  for (unsigned threads = 1; threads <= 3; ++threads)
    REQUIRE_THROWS_WITH(complete_shard(dir.file("seeds"), dir.file("grid"), threads),
                        Catch::Matchers::Matches("conversion at point [0-9]+ \\(2, [0-9], [0-9]\\) "
                                                 "level [0-9]+, direction [0-9]+: told to fail"));
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
  expand_shards({dir.file("seeds")}, {}, dir.file("requests"), 13);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  // Two pauses a thread; one thread would make 26 of them.
  CHECK(time.count() > 2 * 0.05);
  CHECK(time.count() < 26 * 0.05);
}
