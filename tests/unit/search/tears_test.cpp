// Tear fractions against their definition, written down once more for the toy model, and against
// the hung ball followed in small steps.
#include "libcore/search/tears.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "libcore/grid/describe.hpp"
#include "libcore/grid/vec3.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/hung_ball/grid.hpp"
#include "tests/unit/search/shards.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;

namespace {

using State = std::vector<double>;

/// The interval of the toy's link, from its definition in words. All positions are exact.
int toy_tear(const Grid& grid, RecordIndex r, int q, const toy::Toy& toy) {
  const Vec3 x = grid.box().position(grid.point(r));
  const auto step = Direction(q).step();
  const auto along = [&](double from, double to, const State& s) {
    const double h = grid.box().spacing;
    const Vec3 link = h * Vec3{1.0 * step[0], 1.0 * step[1], 1.0 * step[2]};
    const Vec3 at = x + from * link, by = (to - from) * link;
    State reached(s.size());
    toy::convert(toy, s.data(), at.data(), by.data(), reached.data());
    return reached;
  };
  const auto apart = [](const State& a, const State& b) {
    double most = 0;
    for (std::size_t c = 0; c < std::min<std::size_t>(2, a.size()); ++c)
      most = std::max(most, std::abs(a[c] - b[c]));
    return most;
  };
  const auto state = [&](RecordIndex i) {
    return State(grid.state(i).begin(), grid.state(i).end());
  };
  State before = state(r), behind = state(grid.destination(r, q));
  double low = 0, high = 1;
  for (int i = 0; i < 5; ++i) {
    const double middle = (low + high) / 2;
    const State s = along(low, middle, before);
    const double to_before = apart(s, before), to_behind = apart(s, behind);
    bool on_branch = to_before < to_behind;
    if (i == 0 || (to_before * 4 > to_behind && to_behind * 4 > to_before)) {
      const State back = along(middle, low, s);
      on_branch = toy::equal(toy, back.data(), before.data());
    }
    (on_branch ? low : high) = middle;
    (on_branch ? before : behind) = s;
  }
  return static_cast<int>(low * 32);
}

/// A model that works on seven conversions at a time, and answers them in any order.
class Jumbled : public Model {
 public:
  explicit Jumbled(std::unique_ptr<Model> model) : Model(model->info()), model_(std::move(model)) {}
  State known_states(const Vec3& x) override { return model_->known_states(x); }
  bool convert(const double* s, const Vec3& x, const Vec3& d, double* row) override {
    return model_->convert(s, x, d, row);
  }
  void convert_all(const NextConversion& next, const ConversionDone& done) override {
    std::vector<Conversion> open;
    for (Conversion c;;) {
      while (open.size() < 7 && next(c, open.empty())) open.push_back(c);
      if (open.empty()) return;
      std::swap(open.back(), open[random_() % open.size()]);
      c = open.back();
      open.pop_back();
      REQUIRE(convert(c.s, c.x, c.d, c.row));
      done(c, "");
    }
  }
  bool complete(const Vec3& x, double* row) override { return model_->complete(x, row); }
  bool equal(const double* a, const double* b) const override { return model_->equal(a, b); }

 private:
  std::unique_ptr<Model> model_;
  Random random_{7};
};

/// A model that cannot make the part of a step.
class Coarse : public Jumbled {
 public:
  using Jumbled::Jumbled;
  bool convert(const double*, const Vec3&, const Vec3&, double*) override { return false; }
  void convert_all(const NextConversion& next, const ConversionDone& done) override {
    for (Conversion c; next(c, true);) done(c, "too short a step");
  }
};

template <class M>
struct Source : ModelSource {
  const char* kind() const override { return "plug-in"; }
  std::unique_ptr<Model> create(const std::vector<Parameter>& parameters,
                                const Stored&) const override {
    return std::make_unique<M>(toy_plugin().create(parameters));
  }
};

std::vector<TearByte> tears_of(const Grid& grid, const ModelSource& source, unsigned threads) {
  Progress progress;
  Converter converter(source, grid.spec(), threads, progress);
  return find_tears(grid, one_way_links(grid), converter, progress);
}

/// A toy's grid that lacks its tear fractions, and has some one-way links.
std::string torn_grid(Random& random, const TemporaryDirectory& dir) {
  for (;;) {
    Case c(random);
    c.definition.tears = true;
    std::string grid = dir.file("0");
    write_seed_shard(c, grid);
    for (int round = 1; open_grid(grid).frontier() > 0; ++round) {
      expand_shard(grid, {}, dir.file("requests"));
      const std::string next = dir.file(std::to_string(round));
      merge_shards({grid, dir.file("requests")}, next);
      grid = next;
    }
    if (one_way_links(load_grid(grid).grid).size() > 10) return grid;
  }
}

}  // namespace

TEST_CASE("tear fractions are those of the definition, whatever the parts, threads and order") {
  Random random(20071);
  std::array<int, kTearSteps> found{};
  for (int i = 0; i < 15; ++i) {
    CAPTURE(i);
    const TemporaryDirectory dir;
    Case c(random);
    c.definition.tears = true;
    std::string grid = dir.file("0");
    write_seed_shard(c, grid);
    complete_shard(grid, dir.file("complete"), static_cast<unsigned>(draw(random, 1, 4)));
    for (int round = 1; open_grid(grid).next_round(); ++round) {
      const auto parts = static_cast<std::uint64_t>(draw(random, 1, 4));
      std::vector<std::string> inputs{grid};
      for (std::uint64_t k = 1; k <= parts; ++k) {
        inputs.push_back(dir.file("part" + std::to_string(k)));
        expand_shard(grid, {k, parts}, inputs.back(), static_cast<unsigned>(draw(random, 1, 3)));
      }
      if (draw(random, 0, 2) == 0) inputs.push_back(inputs.back());
      std::shuffle(inputs.begin(), inputs.end(), random);
      grid = dir.file(std::to_string(round));
      merge_shards(inputs, grid);
    }
    const LoadedGrid complete = load_grid(dir.file("complete"));
    REQUIRE(load_grid(grid).digest == complete.digest);
    const Grid& g = complete.grid;
    REQUIRE(g.has_tears());
    for (RecordIndex r = 0; r < g.records(); ++r)
      for (int q = 0; q < kDirections; ++q) {
        CAPTURE(r, q);
        const TearByte tear = g.tears(r)[static_cast<std::size_t>(q)];
        const RecordIndex there = g.destination(r, q);
        const bool one_way = there != Grid::kNoRecord && g.destination(there, 25 - q) != r;
        REQUIRE(int{tear} == (one_way ? toy_tear(g, r, q, c.toy) : int{kNoTear}));
        if (one_way) ++found[tear];
      }
    // Nothing is left to be done, and a merge leaves it as it is.
    expand_shard(grid, {}, dir.file("nothing"));
    merge_shards({grid, dir.file("nothing")}, dir.file("same"));
    REQUIRE(load_grid(dir.file("same")).digest == complete.digest);
  }
  REQUIRE(*std::min_element(found.begin(), found.end()) > 0);  // each interval was put to the test
}

TEST_CASE("a model that answers in any order finds the same tear fractions") {
  Random random(20072);
  const TemporaryDirectory dir;
  const Grid grid = load_grid(torn_grid(random, dir)).grid;
  const std::vector<TearByte> expected = tears_of(grid, toy_plugin(), 1);
  for (const unsigned threads : {1u, 3u})
    REQUIRE(tears_of(grid, Source<Jumbled>{}, threads) == expected);
}

TEST_CASE("a conversion that fails is an error that names the first link") {
  Random random(20073);
  const TemporaryDirectory dir;
  const Grid grid = load_grid(torn_grid(random, dir)).grid;
  const OneWayLink first = one_way_links(grid).front();
  for (const unsigned threads : {1u, 4u})
    REQUIRE_THROWS_WITH(
        tears_of(grid, Source<Coarse>{}, threads),
        "tear fraction of " + describe_link(grid, first.record, first.q) + ": too short a step");
}

TEST_CASE("the failure of a thread ends the work of the others, and reaches the caller") {
  Random random(3);
  const TemporaryDirectory dir;
  write_seed_shard(Case(random), dir.file("seeds"));
  Progress progress;
  Converter converter(toy_plugin(), open_grid(dir.file("seeds")).header.spec, 3, progress);
  for (const bool is_first : {false, true}) {
    WorkQueue endless(std::uint64_t{1} << 62, converter.models(), 1, progress);
    std::atomic<int> failures{0};
    const auto work = [&](Model& model) {
      if ((&model == &converter.model()) == is_first && failures++ == 0) throw Error("thrown");
      WorkQueue::Slice mine;
      for (std::uint64_t item; endless.next(mine, true, item);) {
      }
    };
    CHECK_THROWS_WITH(converter.run(endless, work), "thrown");
  }
}

TEST_CASE("merge refuses tear fractions of no one-way link, and two different ones of a link") {
  Random random(20074);
  const TemporaryDirectory dir;
  const std::string name = torn_grid(random, dir);
  const Grid grid = load_grid(name).grid;
  const std::vector<OneWayLink> links = one_way_links(grid);
  const SectionHeader header{Content::kTears, grid.generation(), grid.spec()};
  const auto merge_links = [&](const std::vector<OneWayLink>& own, TearByte tear) {
    write_shard(dir.file("some"), header, [&](SectionWriter& out) {
      write_tears(grid, own, std::vector<TearByte>(own.size(), tear), out);
    });
    merge_shards({name, dir.file("some")}, dir.file("out"));
  };
  // A link there and back.
  OneWayLink other;
  while (grid.destination(other.record, other.q) == Grid::kNoRecord ||
         grid.is_one_way(other.record, other.q))
    other = other.q < 25 ? OneWayLink{other.record, static_cast<std::uint8_t>(other.q + 1)}
                         : OneWayLink{other.record + 1, 0};
  const auto at = [&](OneWayLink link) {
    return describe(grid, link.record) + ", direction " + std::to_string(link.q);
  };
  REQUIRE_THROWS_WITH(merge_links({other}, 6),
                      "tear fractions: " + at(other) + ": the grid has no such one-way link");
  merge_links(links, 6);
  REQUIRE(load_grid(dir.file("out")).grid.tears(links[0].record)[links[0].q] == 6);
  write_shard(dir.file("wrong"), header, [&](SectionWriter& out) {
    const TearByte tear = 7;
    write_tears(grid, {&links[0], 1}, {&tear, 1}, out);
  });
  REQUIRE_THROWS_WITH(merge_shards({name, dir.file("wrong"), dir.file("some")}, dir.file("two")),
                      "tear fractions: " + at(links[0]) + ": two different answers");
  // A level that the grid lacks.
  write_shard(dir.file("level"), header, [&](SectionWriter& out) {
    const TearByte tear = 7;
    out.tears(
        grid.point(0), 200,
        grid.neighbourhood().inside(grid.point(0)) & -grid.neighbourhood().inside(grid.point(0)),
        &tear);
    out.finish();
  });
  REQUIRE_THROWS_WITH(merge_shards({name, dir.file("level")}, dir.file("two")),
                      Catch::Matchers::EndsWith(": the grid has no such one-way link"));
}

TEST_CASE("the hung ball snaps where small steps along the link say") {
  const auto model = hung_ball::make();
  const Grid grid = hung_ball::grid({{-0.975, -0.475, -0.475}, 0.05, {40, 20, 20}}, true);
  const std::vector<OneWayLink> links = one_way_links(grid);
  REQUIRE(links.size() > 9000);
  // Small steps snap where one of them moves the ball more than any other. It lies in the interval
  // that the bisections found: its middle is half an interval and half a step from theirs at most.
  constexpr int kSteps = 10 * kTearSteps;
  constexpr double h = 1.0 / kSteps;
  for (const auto [r, q] : links) {
    const Vec3 x = grid.box().position(grid.point(r));
    const Vec3 d = grid.neighbourhood().shift(q);
    double s = grid.state(r)[0], largest = -1, snap = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double t = h * i;
      double next = std::nan("");
      model->convert(&s, x + t * d, h * d, &next);
      if (std::abs(next - s) > largest) {
        largest = std::abs(next - s);
        snap = t + h / 2;
      }
      s = next;
    }
    CAPTURE(describe_link(grid, r, q), snap);
    REQUIRE(std::abs(snap - tear_fraction(grid.tears(r)[q])) <= 0.5 / kTearSteps + h / 2 + 1e-9);
  }
}
