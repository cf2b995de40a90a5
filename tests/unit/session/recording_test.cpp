// What a hand did, from sessions; and a device that does it again.
#include "libcore/session/recording.hpp"

#include "libcore/device/path.hpp"
#include "libcore/session/recorder.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"
#include "tests/unit/session/ticks.hpp"
#include "tests/unit/temporary_directory.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

const TemporaryDirectory kDirectory;

}  // namespace

TEST_CASE("the hand's part of a session") {
  std::vector<TickRecord> ticks = random_ticks(5000, 1);
  const std::string file = kDirectory.file("x.session");
  SessionWriter writer(file, small_header());
  for (const TickRecord& tick : ticks) writer.add(tick);
  writer.finish();
  SessionReader session(file);
  const std::vector<DeviceInput> got = load_recording(session);
  REQUIRE(got.size() == ticks.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const DeviceInput& tick = got[i];
    TickRecord copy = ticks[i];
    copy.hip = tick.position;
    if (!same(copy, ticks[i]) ||
        tick.missed != (i == 0 ? 0 : ticks[i].number - ticks[i - 1].number - 1) ||
        tick.clutch != ((ticks[i].flags & 1) != 0) || tick.stalled != ((ticks[i].flags & 2) != 0))
      ++wrong;
  }
  CHECK(wrong == 0);
  session.rewind();
  CHECK(load_recording(session, 5000 * sizeof(DeviceInput)).size() == 5000);
  session.rewind();
  CHECK_THROWS_WITH(
      load_recording(session, 5000 * sizeof(DeviceInput) - 1),
      file + ": 5000 ticks or more need " + std::to_string(5000 * sizeof(DeviceInput)) +
          " bytes of memory, the limit is " + std::to_string(5000 * sizeof(DeviceInput) - 1));
}

TEST_CASE("a replay's read() and send() do not allocate") {
  ReplayDevice device(std::vector<DeviceInput>(1000));
  CHECK(ticks_without_allocating(device, 1001) == 1000);
}
