// What a hand did, from sessions and from texts; and a device that does it again.
#include "libcore/session/recording.hpp"

#include <cmath>
#include <fstream>

#include "libcore/device/path.hpp"
#include "libcore/session/recorder.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"
#include "tests/unit/refusal.hpp"
#include "tests/unit/session/ticks.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

const TemporaryDirectory kDirectory;

std::string text_file(const std::string& text) {
  std::string file = kDirectory.file("x.log");
  std::ofstream(file, std::ios::trunc) << text;
  return file;
}

std::string text_refusal(const std::string& text, double rate_hz = 1000) {
  const std::string file = text_file(text);
  const std::string what = testing::refusal([&] { load_recording(file, rate_hz); });
  return what.starts_with(file) ? what.substr(file.size()) : what;
}

}  // namespace

TEST_CASE("the hand's part of a session") {
  std::vector<TickRecord> ticks = random_ticks(5000, 1);
  const std::string file = kDirectory.file("x.session");
  SessionWriter writer(file, small_header());
  for (const TickRecord& tick : ticks) writer.add(tick);
  writer.finish();
  const Recording got = load_recording(file, 77);
  REQUIRE(got.header);
  CHECK(*got.header == small_header());
  REQUIRE(got.ticks.size() == ticks.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const RecordedTick& tick = got.ticks[i];
    TickRecord copy = ticks[i];
    copy.hip = tick.hip;
    if (!same(copy, ticks[i]) || tick.number != ticks[i].number ||
        tick.clutch != ((ticks[i].flags & 1) != 0) || tick.stalled != ((ticks[i].flags & 2) != 0))
      ++wrong;
  }
  CHECK(wrong == 0);
  CHECK_THROWS_WITH(
      load_recording(file, 77, 5000 * sizeof(RecordedTick) - 1),
      file + ": 5000 ticks or more need " + std::to_string(5000 * sizeof(RecordedTick)) +
          " bytes of memory, the limit is " + std::to_string(5000 * sizeof(RecordedTick) - 1));
  CHECK(load_recording(file, 77, 5000 * sizeof(RecordedTick)).ticks.size() == 5000);
}

TEST_CASE("the hand's part of a text") {
  const Recording got = load_recording(
      text_file("# t\ts0\tx\tz\ty\n0.001\t9\t1\t3\t2\n0.0029999999\t9\t-0\tnan\t5e-324\n"), 1000);
  CHECK_FALSE(got.header);
  REQUIRE(got.ticks.size() == 2);
  CHECK(got.ticks[0].number == 1);
  CHECK(got.ticks[0].hip == Vec3{1, 2, 3});
  CHECK(got.ticks[1].number == 3);
  CHECK(std::signbit(got.ticks[1].hip[0]));
  CHECK(got.ticks[1].hip[1] == 5e-324);
  CHECK(std::isnan(got.ticks[1].hip[2]));

  const std::string names = "# t\tx\ty\tz\n", row = "0.001\t1\t2\t2\n";
  const struct {
    std::string text, why;
    double rate_hz = 1000;
  } cases[] = {
      {"", "line 1: no session, and no '# t x y z ...' as play --log writes it"},
      {"0 0 0\n", "line 1: no session, and no '# t x y z ...' as play --log writes it"},
      {"# t\tx\ty\n", "line 1: no column 'z'"},
      {names, "line 1: no ticks after the names of the columns"},
      {names + "0\t1\t2\n", "line 2: column z: not there"},
      {names + "0\t1\tup\t2\n", "line 2: column y: 'up' is no number"},
      {names + "-1\t1\t2\t2\n", "line 2: t = -1 at 1000 Hz is no tick's number"},
      {names + "nan\t1\t2\t2\n", "line 2: t = nan at 1000 Hz is no tick's number"},
      {names + row + row, "line 3: t = 0.001 at 1000 Hz is tick 1, and the line before is tick 1"},
      {names + "0\t1\t2\t2\n" + row,
       "line 3: t = 0.001 at 100 Hz is tick 0, and the line before is tick 0", 100},
  };
  for (const auto& c : cases) CHECK(text_refusal(c.text, c.rate_hz) == ": " + c.why);
}

TEST_CASE("a replay gives back its ticks, and says what was missed") {
  ReplayDevice device({{.position = {1, 2, 3}, .clutch = true},
                       {.position = {4, 5, 6}, .stalled = true, .missed = 2}});
  CHECK(device.size() == 2);
  CHECK(device.info().name == "replay");
  CHECK(device.info().unit == DeviceInfo::Unit::kModel);
  DeviceInput input;
  REQUIRE(device.read(input) == DeviceStatus::kOk);
  CHECK(input.position == Vec3{1, 2, 3});
  CHECK((input.clutch && !input.stalled && input.missed == 0));
  REQUIRE(device.read(input) == DeviceStatus::kOk);
  CHECK(input.position == Vec3{4, 5, 6});
  CHECK((!input.clutch && input.stalled && input.missed == 2));
  CHECK(device.send({0, 1, 0}) == DeviceStatus::kOk);
  CHECK(device.force() == Vec3{0, 1, 0});
  CHECK(device.read(input) == DeviceStatus::kEnd);
  CHECK(device.read(input) == DeviceStatus::kEnd);
  CHECK(input.position == Vec3{4, 5, 6});
  CHECK(device.stop() == DeviceStatus::kOk);
  CHECK(device.force() == Vec3{0, 0, 0});
}

TEST_CASE("a replay's read() and send() do not allocate") {
  ReplayDevice device(std::vector<DeviceInput>(1000));
  CHECK(ticks_without_allocating(device, 1001) == 1000);
}
