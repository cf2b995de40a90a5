// The hand of the live page: where it can go, and what it writes.
#include "tools/view/hand.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>

#include "libcore/base/error.hpp"
#include "libcore/device/hand.hpp"
#include "libcore/device/path.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;

namespace {

// Its longest side is 2, from x = 0.
const Box kBox{.origin = {0, 0, 0}, .spacing = 0.5, .counts = {5, 3, 3}};
/// A hand and who reads its pipe.
struct Ends {
  TemporaryDirectory dir;
  std::string name = dir.file("hand");
  FileDescriptor reader = make();
  Hand hand{name, kBox};

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
    for (int a = 0; a < 3; ++a) CHECK((*hand.place())[a] == Approx(wanted[a]).margin(1e-12));
  }
};

}  // namespace

TEST_CASE("the hand goes where it is put, but not farther out than the HIP can lag behind it") {
  Ends ends;
  CHECK(!ends.hand.place());
  ends.hand.move_to({1.2, 0.5, 0.3});
  ends.check({1.2, 0.5, 0.3});
  ends.hand.move_to({1e9, -1e9, 0.3});
  ends.check({2 + 2 * kHandReach, -2 * kHandReach, 0.3});
  CHECK(hand_range(kBox).first[1] == Approx(-2 * kHandReach));
}

TEST_CASE("the hand writes each new place as a line of a path") {
  Ends ends;
  CHECK(ends.text().empty());
  ends.hand.next_level();
  CHECK(ends.text() == std::string(kHandNext) + "\n");
  for (int i = 0; i < 3; ++i) {
    ends.hand.move_to({0.1 * i, 0.2, 1.0 / 3});
    CHECK(parse_path(ends.text(), "line") == std::vector<PathTick>{{*ends.hand.place()}});
  }
  // A pipe that nobody empties, or that nobody has any more, stops nobody.
  for (int i = 0; i < 5000; ++i) ends.hand.move_to({i % 2 ? 1.0 : 0.5, 0, 0});
  ends.reader = FileDescriptor();
  ends.hand.move_to({1, 0, 0});
  CHECK_THROWS_AS(Hand(ends.name, kBox), Error);
}
