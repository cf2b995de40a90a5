// Curves of the last seconds, and the line of numbers.
#include "tools/view/traces.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace hapgrid;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Frame frame_at(double time_s, Vec3 force = {0, 0, 0}, double energy = kNan) {
  Frame frame;
  frame.time_s = time_s;
  frame.force = force;
  frame.energy = energy;
  return frame;
}

}  // namespace

TEST_CASE("the last ten seconds stay, and where the time goes back curves start anew") {
  Traces traces;
  for (int i = 0; i <= 500; ++i) traces.add(frame_at(i / 25.0));
  REQUIRE(traces.samples().size() == 251);  // both ends
  CHECK(traces.samples().front().time_s == 10);
  CHECK(traces.samples().back().time_s == 20);
  traces.add(frame_at(1e300));
  CHECK(traces.samples().size() == 1);
  traces.add(frame_at(4));
  REQUIRE(traces.samples().size() == 1);
  CHECK(traces.samples()[0].time_s == 4);
}

TEST_CASE("a stream of very many frames a second takes no more memory") {
  Traces traces;
  for (int i = 0; i < 100000; ++i) traces.add(frame_at(1e-6 * i));
  CHECK(traces.samples().size() == Traces::kMaxSamples);
  CHECK(traces.samples().back().time_s == Approx(0.099999));
}

TEST_CASE("more jumps than in the frame before are a snap, other levels are none") {
  Traces traces;
  for (int i = 0; i < 4; ++i) {
    Frame frame = frame_at(i);
    frame.jumps = i < 2 ? 2 : 3;  // nothing is before the first ones
    frame.levels[3] = i == 3;
    traces.add(frame);
  }
  std::vector<bool> snapped;
  for (const auto& s : traces.samples()) snapped.push_back(s.snapped);
  CHECK(snapped == std::vector<bool>{false, false, true, false});
}

TEST_CASE("columns are equal parts of ten seconds") {
  Traces traces;
  CHECK(traces.columns(3).size() == 3);
  CHECK(traces.columns(0).empty());
  // From 95 s to 100 s: of ten columns the left five are before the first sample.
  for (int i = 0; i <= 50; ++i) {
    Frame frame = frame_at(95 + 0.1 * i, {static_cast<double>(i % 10), 0, 0}, i);
    frame.jumps = i >= 25;  // at 97.5 s
    traces.add(frame);
  }
  const auto curve = traces.columns(10);
  REQUIRE(curve.size() == 10);
  for (int c = 0; c < 5; ++c) {
    CHECK(std::isnan(curve[c].force));
    CHECK(std::isnan(curve[c].energy));
  }
  for (int c = 5; c < 10; ++c) {
    CHECK(curve[c].force == 9);
    CHECK(curve[c].snapped == (c == 7));
  }
  CHECK(curve[9].energy == 50);  // the newest
  // More columns than samples: a value holds until the next one.
  const auto fine = traces.columns(1000);
  REQUIRE(fine.size() == 1000);
  CHECK(fine[999].energy == 50);
  CHECK(fine[995].energy == 49);
  CHECK(std::isnan(fine[490].force));
  for (int c = 510; c < 1000; ++c) CHECK(std::isfinite(fine[c].force));
  int marks = 0;
  for (const Traces::Sample& column : fine) marks += column.snapped;
  CHECK(marks == 1);
}

TEST_CASE("the numbers as a line") {
  Scene scene;
  scene.energy_unit = "kJ/mol";
  Frame frame = frame_at(3.2, {0.3, 0, 0.4}, 12.345);
  CHECK(status_text(scene, frame) == "t 3.20 s   force 0.5 N   energy 12.3 kJ/mol");
  frame.energy = kNan;
  CHECK(status_text(scene, frame) == "t 3.20 s   force 0.5 N");
  // The model's own energy, and the torsion that has turned farthest.
  scene.torsions = {{{}, "phi"}, {{}, "psi"}, {{}, "chi"}};
  frame.energy = 12.345;
  frame.own_energy = 9.06;
  frame.turned = {-20, 66.7, kNan};
  CHECK(status_text(scene, frame) ==
        "t 3.20 s   force 0.5 N   energy 12.3 kJ/mol   model alone 9.06   psi +67°");
  frame.own_energy = kNan;
  frame.turned = {9, -9, kNan};
  CHECK(status_text(scene, frame) == "t 3.20 s   force 0.5 N   energy 12.3 kJ/mol");
  // Strings and numbers of a stream are hostile.
  scene.energy_unit = "\033[2J\n";
  frame.energy = -1e-7;
  frame.force = {1e308, 1e308, 1e308};
  frame.time_s = 1e300;
  CHECK(status_text(scene, frame) == "t 1e+300 s   force 1.73e+308 N   energy -1e-07  [2J ");
}
