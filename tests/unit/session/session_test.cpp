// What is recorded comes back to the last bit, up to where a file is cut or damaged.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>

#include "libcore/base/error.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/session/reader.hpp"
#include "libcore/session/writer.hpp"
#include "tests/unit/refusal.hpp"
#include "tests/unit/session/ticks.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

void write(const std::string& file, const std::vector<TickRecord>& ticks, std::uint64_t dropped = 0,
           const SessionHeader& header = small_header()) {
  SessionWriter writer(file, header);
  for (const TickRecord& tick : ticks) writer.add(tick);
  writer.finish(dropped);
}

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void put_bytes(const std::string& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
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

TEST_CASE("a session that was interrupted has all its whole chunks") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  const std::vector<TickRecord> ticks = random_ticks(9000, 5);
  put_bytes(file, "an old one");
  {
    SessionWriter writer(file, small_header());
    for (const TickRecord& tick : ticks) writer.add(tick, 3);
    // Another process can read it meanwhile.
    SessionReader reader(file);
    CHECK(same(rest_of(reader), {ticks.begin(), ticks.begin() + 8192}));
    CHECK(reader.dropped() == 3);
  }
  SessionReader reader(file);
  CHECK(same(rest_of(reader), {ticks.begin(), ticks.begin() + 8192}));
  CHECK(reader.ended_early() == "");
}

TEST_CASE("a session that is cut or damaged ends before that zstd frame") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  const std::vector<TickRecord> ticks = random_ticks(9000, 6);
  write(file, ticks);
  const std::string bytes = bytes_of(file);
  std::vector<std::size_t> at{0};  // where the zstd frames are, and the file's end
  while (at.back() < bytes.size())
    at.push_back(at.back() + zstd_frame_size(std::as_bytes(std::span(bytes)).subspan(at.back())));
  REQUIRE(at.size() == 5);
  // Reads other bytes: the first `chunks` chunks must be there, and why the others are not.
  const auto check = [&](const std::string& other, std::size_t chunks, const std::string& why) {
    put_bytes(file, other);
    SessionReader reader(file);
    const std::size_t count = std::min(4096 * chunks, ticks.size());
    CHECK(same(rest_of(reader), {ticks.begin(), ticks.begin() + static_cast<long>(count)}));
    CHECK_THAT(reader.ended_early(), Catch::Equals(why) || Catch::StartsWith(why + ": damaged: "));
  };
  const auto place = [&](std::size_t frame, std::size_t size) {
    return "byte " + std::to_string(at[frame]) + " of " + std::to_string(size);
  };
  for (std::size_t frame = 1; frame < 5; ++frame) check(bytes.substr(0, at[frame]), frame - 1, "");
  for (const std::size_t size : {at[2] + 1, at[2] + 5, at[3] - 1})
    check(bytes.substr(0, size), 1, place(2, size) + ": a zstd frame is cut");
  check(bytes + "x", 3, place(4, bytes.size() + 1) + ": a zstd frame is cut");
  std::string flipped = bytes;
  flipped[at[2] + 1000] ^= 1;
  check(flipped, 1, place(2, bytes.size()));
  // A computer that lost its power may leave zeros.
  check(bytes.substr(0, at[2]) + std::string(5000, '\0'), 1,
        place(2, at[2] + 5000) + ": a zstd frame is cut");
  // Chunks in another order, and one twice.
  const auto frames = [&](auto... which) {
    return (bytes.substr(at[which], at[which + 1] - at[which]) + ...);
  };
  const std::string again = frames(0U, 1U, 1U);
  check(again, 1, place(2, again.size()));
  put_bytes(file, frames(0U, 2U, 1U));
  SessionReader reader(file);
  CHECK(same(rest_of(reader), {ticks.begin() + 4096, ticks.begin() + 8192}));
  CHECK_THAT(reader.ended_early(),
             Catch::EndsWith(": damaged: tick " + std::to_string(ticks[0].number) + " after tick " +
                             std::to_string(ticks[8191].number)));
}

TEST_CASE("what is no session is called so") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x");
  put_bytes(file, "");
  CHECK_THROWS_WITH(SessionReader(file), file + ": byte 0: not a session: no zstd frame");
  put_bytes(file, "# t\tx\ty\tz\n");
  CHECK_THROWS_WITH(SessionReader(file), file + ": byte 0: not a session: no zstd frame");
  write(file, {});
  put_bytes(file, bytes_of(file).substr(0, 40));
  CHECK_THROWS_WITH(SessionReader(file), file + ": byte 0: not a session, or its header is cut");
  CHECK_THROWS_AS(SessionReader(directory.file("none")), std::system_error);
}

TEST_CASE("a header that cannot be is refused before anything is written") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x");
  const auto refusal = [&](auto&& change) {
    SessionHeader header = small_header();
    change(header);
    return testing::refusal([&] { SessionWriter(file, header); });
  };
  CHECK(refusal([](SessionHeader& h) { h.rate_hz = 0; }) ==
        "a rate of 0 Hz; 1e-06 to 1e+09 are possible");
  CHECK(refusal([](SessionHeader& h) { h.rate_hz = std::nan(""); }) ==
        "a rate of nan Hz; 1e-06 to 1e+09 are possible");
  CHECK(refusal([](SessionHeader& h) { h.flags.resize(33); }) == "33 flags, the limit is 32");
  CHECK(refusal([](SessionHeader& h) { h.settings.resize((512 << 10) + 1); }) ==
        "settings of 524289 bytes, the limit is 524288");
  CHECK(refusal([](SessionHeader& h) { h.box.spacing = -1; }) != "");
  CHECK(std::filesystem::is_empty(directory.path()));
  // The largest one that can be comes back.
  SessionHeader large = small_header();
  large.settings.assign(512 << 10, 'x');
  large.model.assign(255, 'm');
  large.flags.assign(32, std::string(255, 'f'));
  write(file, {}, 0, large);
  CHECK(SessionReader(file).header() == large);
}

TEST_CASE("ticks have to ascend") {
  const TemporaryDirectory directory;
  SessionWriter writer(directory.file("x"), small_header());
  TickRecord tick;
  tick.number = 5;
  writer.add(tick);
  CHECK_THROWS_WITH(writer.add(tick), directory.file("x") + ": tick 5 after tick 5");
}
