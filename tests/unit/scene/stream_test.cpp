// The stream of frames: what was written is read; tests/cli/view/view.sh has what is refused.
#include "libcore/scene/stream.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <numbers>

#include "libcore/base/error.hpp"
#include "libcore/scene/scene.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/scene/scenes.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;
using Catch::Matchers::StartsWith;

namespace {

using Bytes = std::vector<std::byte>;

Bytes scene_bytes(const Scene& scene) {
  Bytes bytes;
  append(bytes, SceneEncoder().encode(scene));
  return bytes;
}
Bytes frame_bytes(const Frame& frame) {
  Bytes bytes;
  append(bytes, SceneEncoder().encode(frame, frame.row.size()));
  return bytes;
}
Bytes operator+(Bytes a, const Bytes& b) {
  append(a, b);
  return a;
}

std::uint64_t read_all(const Bytes& bytes) {
  SceneReader reader(file_of(bytes), "f");
  std::uint64_t frames = 0;
  for (Frame frame; reader.next(frame);) ++frames;
  return frames;
}

bool same(const Frame& a, const Frame& b) {
  const auto known = [](double x) { return std::isnan(x) ? std::nullopt : std::optional(x); };
  const auto all = [&](const Frame& f) {
    return std::tuple(f.tick, f.time_s, f.hip, f.position, f.force, f.row, f.jumps, f.centres,
                      known(f.energy), known(f.own_energy));
  };
  return all(a) == all(b);
}

const Bytes kStart = scene_bytes(kScene);

}  // namespace

TEST_CASE("scene and frames come back as they were") {
  Bytes bytes;
  SceneEncoder encoder;
  append(bytes, encoder.encode(kScene));
  for (const std::uint64_t tick : {0, 40, 41})
    append(bytes, encoder.encode(small_frame(tick), kScene.state_size));
  SceneReader reader(file_of(bytes), "f");
  CHECK(reader.scene() == kScene);
  Frame frame;
  for (const std::uint64_t tick : {0, 40, 41}) {
    REQUIRE(reader.next(frame));
    CHECK(same(frame, small_frame(tick)));
  }
  CHECK_FALSE(reader.next(frame));
  CHECK_FALSE(reader.next(frame));
}

TEST_CASE("torsions are followed from the first frame on") {
  Scene scene = kScene;
  scene.spheres.resize(4);
  scene.torsions = {{{0, 1, 2, 3}, "phi"}, {{3, 2, 1, 0}, "back"}, {{0, 1, 1, 2}, "none"}};
  Frame frame = small_frame(0);
  // Along +z from the second to the third, a turn from x towards y is clockwise: positive.
  const auto at = [&](double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    const auto x = static_cast<float>(std::cos(a)), y = static_cast<float>(std::sin(a));
    frame.centres = {2, 0, 0, 0, 0, 0, 0, 0, 1, x, y, 3};
    ++frame.tick;
  };
  for (const double degrees : {-179.0, -90.0, -1.0, 0.0, 60.0, 179.0}) {
    at(degrees);
    CHECK(torsion_degrees(scene.torsions[0], frame.centres) == Approx(degrees).margin(1e-4));
    CHECK(torsion_degrees(scene.torsions[1], frame.centres) == Approx(degrees).margin(1e-4));
    CHECK(std::isnan(torsion_degrees(scene.torsions[2], frame.centres)));
  }
  Bytes bytes = scene_bytes(scene);
  const std::vector<std::array<double, 2>> turns{{170, 0}, {-170, 20}, {100, -70}, {-20, 170}};
  for (const auto& [degrees, turned] : turns) {
    at(degrees);
    bytes = bytes + frame_bytes(frame);
  }
  SceneReader reader(file_of(bytes), "f");
  CHECK(reader.scene() == scene);
  for (const auto& [degrees, turned] : turns) {
    REQUIRE(reader.next(frame));
    REQUIRE(frame.turned.size() == 3);
    CHECK(frame.angles[0] == Approx(degrees).margin(1e-4));
    CHECK(frame.turned[0] == Approx(turned).margin(1e-4));
    CHECK(frame.turned[1] == Approx(turned).margin(1e-4));
    CHECK(std::isnan(frame.turned[2]));
  }
  CHECK(torsion_text(scene.torsions[0], 66.7) == "phi +67°");
  CHECK(torsion_text(scene.torsions[0], -170) == "phi −170°");
}

TEST_CASE("a frame is there as soon as its last byte is") {
  int ends[2];
  REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0);
  const FileDescriptor writer(ends[0]);
  const auto send = [&](const Bytes& bytes) {
    REQUIRE(::write(writer.get(), bytes.data(), bytes.size()) ==
            static_cast<ssize_t>(bytes.size()));
  };
  send(kStart);
  SceneReader reader(FileDescriptor(ends[1]), "f");  // would wait for ever if it wanted more
  Frame frame;
  for (const std::uint64_t tick : {3, 4, 9}) {
    send(frame_bytes(small_frame(tick)));
    REQUIRE(reader.next(frame));
    CHECK(frame.tick == tick);
  }
}

TEST_CASE("a claim beyond the limit takes no memory") {
  // A segment of 2^32 - 1 words.
  Bytes bytes(8);
  std::memset(bytes.data() + 4, 0xff, 4);
  CHECK_THROWS_WITH(read_all(bytes),
                    "f: byte 0: a message of 34359738368 bytes, the limit is 67108864");
  CHECK_THROWS_WITH(
      read_all(kStart + bytes),
      StartsWith("f: byte " + std::to_string(kStart.size()) + ": a message of 34359738368 bytes"));
  // 512 segments.
  bytes = Bytes(4096);
  bytes[0] = std::byte{0xff};
  bytes[1] = std::byte{1};
  CHECK_THROWS_AS(read_all(bytes), FormatError);
  bytes[1] = std::byte{2};
  CHECK_THROWS_WITH(read_all(bytes),
                    "f: byte 0: neither a grid nor a stream of frames, or damaged");
}
