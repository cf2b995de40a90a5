// The mouse as a hand: where it goes for so many pixels, and what it writes; and the bar of the
// force.
#include "tools/view/hand.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "libcore/base/error.hpp"
#include "libcore/device/hand.hpp"
#include "libcore/device/path.hpp"
#include "tests/unit/temporary.hpp"
#include "tools/view/force_bar.hpp"

using namespace hapgrid;

namespace {

// Its longest side is 2, from x = 0.
const Box kBox{.origin = {0, 0, 0}, .spacing = 0.5, .counts = {5, 3, 3}};
// A pixel is 0.02 wide.
const RenderOptions kOptions{.width = 100, .height = 100, .supersampling = 1};

/// A hand at the middle of the box and who reads its pipe.
struct Ends {
  TemporaryDirectory dir;
  std::string name = dir.file("hand");
  FileDescriptor reader = make();
  Hand hand{name, kBox};

  Ends() { hand.begin({1, 0.5, 0.5}); }
  FileDescriptor make() const {
    REQUIRE(::mkfifo(name.c_str(), 0600) == 0);
    return FileDescriptor(::open(name.c_str(), O_RDONLY | O_NONBLOCK));
  }
  std::string text() const {
    char bytes[4096];
    const ssize_t count = ::read(reader.get(), bytes, sizeof bytes);
    return {bytes, static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
  }
  void check(const Vec3& wanted) const {
    for (int a = 0; a < 3; ++a) CHECK(hand.place()[a] == Approx(wanted[a]).margin(1e-12));
  }
};

}  // namespace

TEST_CASE("the hand moves in the plane of the picture, pixel by pixel, and the wheel in depth") {
  Ends ends;
  const Camera front{.azimuth_degrees = 0, .elevation_degrees = 0};
  ends.hand.move(front, kOptions, 10, 0);
  ends.check({1.2, 0.5, 0.5});
  ends.hand.move(front, kOptions, 0, 10);
  ends.check({1.2, 0.5, 0.3});
  ends.hand.push(front, 4);  // away, which is y here: 4 of 40 steps for a length of 2
  ends.check({1.2, 0.7, 0.3});
  // From the right side of the box, as near again: up is z, to the right is y.
  ends.hand.move({.azimuth_degrees = 90, .elevation_degrees = 0, .half_width = 0.5}, kOptions, 10,
                 -10);
  ends.check({1.2, 0.8, 0.4});
  ends.hand.push({.azimuth_degrees = 90, .elevation_degrees = 0}, -4);
  ends.check({1.4, 0.8, 0.4});
  // Not farther out than the HIP can lag behind it.
  ends.hand.move(front, kOptions, 1e9, 1e9);
  ends.check({2 + 2 * kHandReach, 0.8, -2 * kHandReach});
}

TEST_CASE("the hand writes each new place as a line of a path") {
  Ends ends;
  const Camera camera;
  ends.hand.send();
  CHECK(ends.text().empty());
  for (int i = 0; i < 3; ++i) {
    ends.hand.move(camera, kOptions, 1, 2);
    ends.hand.send();
    ends.hand.send();
    CHECK(parse_path(ends.text(), "line") == std::vector<Vec3>{ends.hand.place()});
  }
  // A pipe that nobody empties, or that nobody has any more, stops nobody.
  for (int i = 0; i < 5000; ++i) {
    ends.hand.move(camera, kOptions, i % 2 ? 1 : -1, 0);
    ends.hand.send();
  }
  ends.reader = FileDescriptor();
  ends.hand.move(camera, kOptions, 1, 0);
  ends.hand.send();
  CHECK_THROWS_AS(Hand(ends.name, kBox), Error);
}

TEST_CASE("the bar is as full as the force is large") {
  const auto filled = [](double newtons) {
    Drawing drawing;
    RenderOptions options = kOptions;
    options.width = options.height = 400;
    options.letters = false;
    add_force_bar(drawing, newtons, 3, options);
    const double whole = std::abs(drawing.overlay.at(0).to[1] - drawing.overlay.at(0).from[1]);
    return drawing.overlay.size() == 1
               ? 0
               : std::abs(drawing.overlay[1].to[1] - drawing.overlay[1].from[1]) / whole;
  };
  CHECK(filled(0) == 0);
  CHECK(filled(0.75) == Approx(0.25));
  CHECK(filled(3) == Approx(1));
  CHECK(filled(50) == Approx(1));
  Drawing drawing;
  add_force_bar(drawing, 1, 3, kOptions);
  CHECK(drawing.overlay.empty());  // a picture too small for it
}
