// The wavefront against std::sort.
#include "libcore/search/wavefront.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <tuple>

using namespace hapgrid;

namespace {

using Random = std::mt19937_64;

/// Target, source, level, direction, and the first component of the state reached.
using Row = std::tuple<PointIndex, PointIndex, int, int, double>;

struct Source {
  PointIndex point;
  Level level;
  DirectionMask todo;
};

/// A frontier over `spec`'s box: a share of the points, up to three of their levels.
std::vector<Source> random_frontier(Random& random, const GridSpec& spec, double share) {
  const Neighbourhood neighbourhood(spec.box);
  std::vector<Source> sources;
  std::bernoulli_distribution taken(share);
  const bool all_directions = random() % 2;
  for (PointIndex p = 0; p < spec.box.points(); ++p) {
    if (!taken(random)) continue;
    for (int l = 0; l < 3; ++l) {
      if (random() % 2) continue;
      DirectionMask todo = neighbourhood.inside(p);
      if (!all_directions) todo &= static_cast<DirectionMask>(random());
      sources.push_back({p, static_cast<Level>(l), todo});
    }
  }
  return sources;
}

double answer(PointIndex point, int level, int q) { return point * 1000.0 + level * 100 + q; }

void require_sorted(Wavefront& wave, const GridSpec& spec, const std::vector<Source>& sources) {
  std::vector<Row> expected;
  for (const Source& s : sources)
    for (int q = 0; q < kDirections; ++q)
      if (s.todo >> q & 1)
        expected.emplace_back(static_cast<PointIndex>(s.point + wave.neighbourhood().offset(q)),
                              s.point, s.level, q, answer(s.point, s.level, q));
  std::sort(expected.begin(), expected.end());

  std::vector<Row> drained;
  const auto emit = [&](PointIndex target, int q, Wavefront::Slot slot, const double* state) {
    drained.emplace_back(target, wave.point(slot), wave.level(slot), q, state[0]);
  };
  // What the converter does.
  const auto convert = [&](Wavefront::Slot from, Wavefront::Slot to) {
    for (Wavefront::Slot slot = from; slot < to; ++slot)
      for (int q = 0; q < kDirections; ++q)
        if (wave.todo(slot) >> q & 1)
          std::fill_n(wave.reached(slot, q), spec.state_size,
                      answer(wave.point(slot), wave.level(slot), q));
  };
  const std::vector<double> state(spec.state_size, 0.5);
  Wavefront::Slot converted = wave.end();
  for (const Source& s : sources) {
    wave.add(s.point, s.level, state.data(), s.todo);
    if (wave.end() - converted < wave.batch_size()) continue;
    convert(converted, wave.end());
    converted = wave.end();
    wave.drain(wave.settled_before(s.point), emit);
  }
  convert(converted, wave.end());
  wave.drain(spec.box.points(), emit);
  REQUIRE(drained == expected);
}

}  // namespace

TEST_CASE("requests leave the wavefront in order") {
  Random random(2003);
  const auto count = [&](std::uint32_t most) {
    return 1 + static_cast<std::uint32_t>(random() % most);
  };
  for (int i = 0; i < 60; ++i) {
    CAPTURE(i);
    GridSpec spec;
    spec.box.counts = {count(9), count(9), count(9)};
    // Large ones: several batches and blocks of points, with gaps between them.
    if (i % 4 == 0) spec.box.counts = {count(40), count(40), count(40)};
    if (i % 13 == 0) spec.box.counts = {30000, 1, count(2)};
    spec.state_size = i % 5 == 0 ? 700 : count(3);
    if (spec.state_size > 3) spec.box.counts = {count(6), count(6), count(6)};
    Wavefront wave(spec);
    // One wavefront serves generation after generation.
    for (const double share : {0.5, 0.01, 1.0, 0.1, 0.0}) {
      CAPTURE(share);
      require_sorted(wave, spec, random_frontier(random, spec, share));
    }
  }
}
