// What is recorded comes back to the last bit, up to where a file is cut or damaged.
#include <iterator>

#include "libcore/session/reader.hpp"
#include "libcore/session/recorder.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/refusal.hpp"
#include "tests/unit/session/ticks.hpp"
#include "tests/unit/temporary_directory.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

void write(const std::string& file, const std::vector<TickRecord>& ticks, std::uint64_t dropped = 0,
           const SessionHeader& header = small_header()) {
  SessionWriter writer(file, header);
  for (const TickRecord& tick : ticks) writer.add(tick);
  writer.finish(dropped);
}

}  // namespace

TEST_CASE("a session comes back to the last bit, and again after rewind()") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  for (const std::size_t count : {0, 1, 2, 4095, 4096, 4097, 8192, 10000}) {
    const std::vector<TickRecord> ticks = random_ticks(count, count);
    write(file, ticks, 7);
    SessionReader reader(file);
    CHECK(reader.header() == small_header());
    for (int times = 0; times < 2; ++times) {
      CHECK(same(rest_of(reader), ticks));
      CHECK(reader.dropped() == (count == 0 ? 0 : 7));
      CHECK(reader.ended_early() == "");
      reader.rewind();
      CHECK(reader.dropped() == 0);
    }
  }
}

// By the rules of the reader: cli/stats/session has what they are.
TEST_CASE("a header that cannot be is refused before anything is written") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x");
  SessionHeader bad = small_header();
  bad.rate_hz = 0;
  CHECK(refusal([&] { SessionWriter(file, bad); }) ==
        "a rate of 0 Hz; 1e-06 to 1e+09 are possible");
  CHECK(std::filesystem::is_empty(directory.path()));
  // The largest one that can be comes back.
  SessionHeader large = small_header();
  large.settings.assign(512 << 10, 'x');
  large.model.assign(255, 'm');
  large.flags.assign(32, std::string(255, 'f'));
  write(file, {}, 0, large);
  CHECK(SessionReader(file).header() == large);
}
