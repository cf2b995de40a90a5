// The strip of numbers and curves: where the curves go, and that nothing of a stream harms it.
#include "tools/view/panel.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "tools/view/canvas.hpp"

using namespace hapgrid;

namespace {

bool reddish(const Rgb& p) { return p[0] > p[1] + 100 && p[0] > p[2] + 100; }

/// Ten seconds of frames that `set` fills.
template <class Set>
Traces ten_seconds(Set&& set) {
  Traces traces;
  for (int i = 0; i <= 250; ++i) {
    Frame frame;
    frame.time_s = i / 25.0;
    set(frame);
    traces.add(frame);
  }
  return traces;
}

/// The middle of what is reddish in a column of the picture; NaN where nothing is.
double red_row(const Image& image, int x) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    if (!reddish(image.at(x, y))) continue;
    sum += y;
    ++count;
  }
  return sum / count;
}

}  // namespace

TEST_CASE("a curve rises to the right when the force does") {
  const Scene scene;
  const Traces traces = ten_seconds([](Frame& frame) { frame.force = {frame.time_s / 10, 0, 0}; });
  for (const int scale : {1, 2}) {
    const Image image = draw_panel(600, scale, scene, traces, "status");
    REQUIRE(image.width == 600);
    REQUIRE(image.height == scale * kPanelHeight);
    double last = red_row(image, 250);
    for (int x = 270; x < 590; x += 20) {
      const double row = red_row(image, x);
      CHECK(row < last);
      last = row;
    }
    // A straight line: halfway in time, halfway up.
    const double left = red_row(image, 250), right = red_row(image, 550);
    CHECK(red_row(image, 400) == Approx(0.5 * (left + right)).margin(1.5 * scale));
  }
}

TEST_CASE("the energy of the model itself has a curve of its own beside the energy") {
  Scene scene;
  scene.energy_unit = "kJ/mol";
  const auto green = [&](double own_energy) {
    const Traces traces =
        ten_seconds([&](Frame& frame) { frame.energy = 10, frame.own_energy = own_energy; });
    const Image image = draw_panel(600, 1, scene, traces, "status");
    std::vector<int> rows;  // where a column of the curves is green
    for (int y = 0; y < image.height; ++y)
      if (const Rgb p = image.at(300, y); p[1] > p[0] + 80 && p[1] > p[2] + 20) rows.push_back(y);
    return rows;
  };
  CHECK(green(std::numeric_limits<double>::quiet_NaN()).empty());
  // The axis goes from 0 to 10, and then from 10 to 15.
  REQUIRE(green(0).size() == 1);
  REQUIRE(green(15).size() == 1);
  CHECK(green(15)[0] < green(0)[0] - 10);
}

TEST_CASE("values that are no places draw nothing and harm nothing") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kMost = std::numeric_limits<double>::max();
  Scene scene;
  scene.energy_unit = std::string(255, '\033');
  for (const double value : {nan, kMost, -kMost, std::numeric_limits<double>::denorm_min()}) {
    Traces traces;
    for (const double time_s : {-kMost, 0.0, 1e-300, kMost}) {
      Frame frame;
      frame.time_s = time_s;
      frame.force = {value, value, 0};
      frame.energy = value;
      traces.add(frame);
      frame.time_s = time_s;
      frame.energy = 1;
      traces.add(frame);
      for (const int width : {1, 130, 300})
        CHECK(draw_panel(width, 1, scene, traces, std::string(1000, 'x')).pixels.size() ==
              static_cast<std::size_t>(width) * kPanelHeight);
      CHECK(columns(traces, 7).size() == 7);
    }
  }
}
