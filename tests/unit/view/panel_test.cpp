// The strip of numbers and curves: where the curves go, and that nothing of a stream harms it.
#include "tools/view/panel.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "tools/view/canvas.hpp"

using namespace hapgrid;

namespace {

constexpr Rgb kBlack{0, 0, 0};
constexpr Rgb kWhite{255, 255, 255};

bool reddish(const Rgb& p) { return p[0] > p[1] + 100 && p[0] > p[2] + 100; }

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

TEST_CASE("letters are where they are written, and stay in the picture") {
  Image image = blank(30, 15, kWhite);
  write(image, 1, 1, 1, "|\n", kBlack);  // what is no letter is '?'
  int first = 0, second = 0;
  for (int y = 0; y < 15; ++y)
    for (int x = 0; x < 30; ++x) {
      if (image.at(x, y) != kBlack) continue;
      REQUIRE(x >= 1);
      REQUIRE(x < 1 + 2 * kLetterWidth);
      (x < 1 + kLetterWidth ? first : second)++;
    }
  CHECK(first >= 8);  // a bar
  CHECK(second >= 5);
  Image again = blank(30, 15, kWhite);
  write(again, 1, 1, 1, "|?", kBlack);
  CHECK(again.pixels == image.pixels);
  // Twice as large, each pixel is four.
  Image large = blank(60, 30, kWhite);
  write(large, 2, 2, 2, "|?", kBlack);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 60; ++x) REQUIRE(large.at(x, y) == image.at(x / 2, y / 2));
  write(image, -100, -100, 3, "outside", kBlack);
  write(image, 28, 14, 3, "outside", kBlack);
  line(image, -50, -50, 50, 90, 2, kBlack);
}

TEST_CASE("a curve rises to the right when the force does") {
  const Scene scene;
  Traces traces;
  for (int i = 0; i <= 250; ++i) {
    Frame frame;
    frame.time_s = i / 25.0;
    frame.force = {i / 250.0, 0, 0};
    traces.add(frame);
  }
  for (const int scale : {1, 2}) {
    const Image image = draw_panel(600, scale, scene, traces, "status");
    REQUIRE(image.width == 600);
    REQUIRE(image.height == scale * kPanelHeight);
    double last = red_row(image, 210);
    for (int x = 230; x < 590; x += 20) {
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
    Traces traces;
    for (int i = 0; i <= 250; ++i) {
      Frame frame;
      frame.time_s = i / 25.0;
      frame.energy = 10;
      frame.own_energy = own_energy;
      traces.add(frame);
    }
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
