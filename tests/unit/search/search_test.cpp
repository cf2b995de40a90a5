// The search against the paper's Algorithm 1, written down line by line in reference.hpp.

#include "tests/unit/catch.hpp"
#include "tests/unit/search/shards.hpp"
#include "tests/unit/temporary_directory.hpp"

using namespace hapgrid;

TEST_CASE("rounds of expand and merge are Algorithm 1, generation by generation") {
  Random random(20031);
  std::size_t most_levels = 0;
  for (int i = 0; i < 9; ++i) {
    CAPTURE(i);
    const TemporaryDirectory dir;
    Case c(random);
    if (i == 0) c.resize({8, 16, 20});  // several chunks
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
    complete_shard(dir.file("grid"), dir.file("complete"),
                   static_cast<unsigned>(draw(random, 1, 4)));
    REQUIRE(open_grid(grid).digest == open_grid(dir.file("complete")).digest);
  }
  // Else the order of requests was not put to the test.
  REQUIRE(most_levels >= 4);
}

TEST_CASE("the failure of a thread ends the work of the others, and reaches the caller") {
  Random random(3);
  const TemporaryDirectory dir;
  write_seed_shard(Case(random), dir.file("seeds"));
  const GridSpec spec = open_grid(dir.file("seeds")).header.spec;
  std::atomic<int> made{0};
  struct Slow : Model {
    Slow(const GridSpec& of, std::atomic<int>& count, bool fails)
        : Model(ModelInfo{of, 1, 0, 0, {}}), made(count), throws(fails) {}
    std::vector<double> known_states(const Vec3&) override { return {}; }
    bool complete(const Vec3&, double*) override { return true; }
    bool equal(const double*, const double*) const override { return true; }
    bool convert(const double*, const Vec3&, const Vec3&, double*) override {
      if (throws) throw Error("thrown");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return ++made > 0;
    }
    std::atomic<int>& made;
    bool throws;
  };
  struct Source : ModelSource {
    const char* kind() const override { return "plug-in"; }
    std::unique_ptr<Model> create(const std::vector<Parameter>&, const Stored&) const override {
      return std::make_unique<Slow>(*spec, *made, failing-- == 0);
    }
    const GridSpec* spec;
    std::atomic<int>* made;
    mutable int failing;
  };
  for (const int failing : {0, 2}) {
    Source source;
    source.spec = &spec;
    source.made = &made;
    source.failing = failing;
    Progress progress;
    Converter converter(source, spec, 3, progress);
    Batch batch(spec);
    const std::vector<double> state(spec.state_size);
    while (!batch.is_full()) batch.add({0, 0, state.data(), kAllDirections});
    CHECK_THROWS_WITH(converter.convert(batch), "thrown");
    CHECK(static_cast<std::size_t>(made.exchange(0)) < batch.conversions() / 4);
  }
}
