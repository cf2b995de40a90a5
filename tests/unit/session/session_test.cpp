// What is recorded comes back, from any tick on, to the last bit; what is damaged does not.
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <sstream>
#include <utility>

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

/// A file without a name that may be damaged.
class Scratch {
 public:
  explicit Scratch(const std::string& bytes) : file_(unlinked_file(directory_.path())) {
    REQUIRE(::write(file_.get(), bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  }
  /// Answers whether it is accepted; what it decodes to is in header and ticks then.
  bool read(SessionReader::Damage damage = SessionReader::Damage::kRefused) {
    try {
      SessionReader reader(InputFile(FileDescriptor(::dup(file_.get())), "bad"), damage);
      header = reader.header();
      ticks = rest_of(reader);
      return true;
    } catch (const FormatError& e) {
      why = e.what();
      return false;
    }
  }

  SessionHeader header;
  std::vector<TickRecord> ticks;
  std::string why;

 private:
  TemporaryDirectory directory_;
  FileDescriptor file_;
};

}  // namespace

TEST_CASE("a session comes back to the last bit") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  for (const std::size_t count : {0, 1, 2, 4095, 4096, 4097, 10000}) {
    const std::vector<TickRecord> ticks = random_ticks(count, count);
    write(file, ticks, 7);
    SessionReader reader(file);
    CHECK(reader.header() == small_header());
    CHECK(reader.ticks() == count);
    CHECK(reader.dropped() == 7);
    CHECK(reader.lost_bytes() == 0);
    CHECK(reader.first_tick() == (count == 0 ? 0 : ticks.front().number));
    CHECK(reader.last_tick() == (count == 0 ? 0 : ticks.back().number));
    CHECK(same(rest_of(reader), ticks));
  }
  CHECK_FALSE(std::filesystem::exists(file + ".part"));
}

TEST_CASE("a session is read from any tick on") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  const std::vector<TickRecord> ticks = random_ticks(10000, 3);
  write(file, ticks);
  SessionReader reader(file);
  for (const std::size_t at : {0, 1, 4095, 4096, 8191, 8192, 9999, 17, 4097}) {
    reader.seek(ticks[at].number);
    CHECK(same(rest_of(reader), {ticks.begin() + static_cast<std::ptrdiff_t>(at), ticks.end()}));
    reader.seek(ticks[at].number + 1);
    std::vector<TickRecord> chunk;
    REQUIRE(reader.next(chunk) == (at < 9999));
    if (at < 9999) CHECK(same(chunk.front(), ticks[at + 1]));
  }
}

TEST_CASE("a time belongs to the first tick that is not before it") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  for (const double rate : {1000.0, 0.001, 333.3, 1e6}) {
    SessionHeader header = small_header();
    header.rate_hz = rate;
    write(file, {}, 0, header);
    const SessionReader reader(file);
    CHECK(reader.tick_at(-1) == 0);
    CHECK(reader.tick_at(0) == 0);
    for (const std::uint64_t n : {1ull, 2ull, 3ull, 999ull, 123456789ull}) {
      const double t = header.time_of(n);
      CHECK(reader.tick_at(t) == n);
      CHECK(reader.tick_at(std::nextafter(t, 1e300)) == n + 1);
      CHECK(reader.tick_at(std::nextafter(t, 0)) == n);
    }
  }
}

TEST_CASE("a session that was interrupted is refused, and salvaged") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  const std::vector<TickRecord> ticks = random_ticks(9000, 5);
  put_bytes(file, "an old one");
  {
    SessionWriter writer(file, small_header());
    for (const TickRecord& tick : ticks) writer.add(tick);
    CHECK(writer.part() == std::filesystem::canonical(file).string() + ".part");
    // Never two at a time, and an interrupted one is not written over.
    CHECK_THROWS_WITH(SessionWriter(file, small_header()), Catch::Contains("is there already"));
  }
  CHECK(bytes_of(file) == "an old one");
  const std::string part = file + ".part";
  CHECK_THROWS_WITH(SessionReader(part),
                    part + ": byte " + std::to_string(std::filesystem::file_size(part)) +
                        ": truncated: no index at its end, as of a session that was interrupted "
                        "(stats --salvage takes what is there)");
  SessionReader reader(part, SessionReader::Damage::kSalvaged);
  CHECK(reader.header() == small_header());
  CHECK(reader.lost_bytes() == 0);
  CHECK(same(rest_of(reader), {ticks.begin(), ticks.begin() + 8192}));  // whole chunks
}

TEST_CASE("nothing stays of a session without a chunk") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  { SessionWriter(file, small_header()).add(random_ticks(1, 1)[0]); }
  CHECK(std::filesystem::is_empty(directory.path()));
}

TEST_CASE("a damaged chunk costs its own ticks alone") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  const std::vector<TickRecord> ticks = random_ticks(9000, 6);
  write(file, ticks, 3);
  std::string bytes = bytes_of(file);
  const std::size_t middle = bytes.size() / 2;  // in the second chunk of three
  bytes[middle] = static_cast<char>(bytes[middle] ^ 1);
  put_bytes(file, bytes);
  {
    SessionReader refused(file);
    CHECK_THROWS_WITH(rest_of(refused), Catch::Contains(": damaged"));
  }
  std::vector<TickRecord> expected(ticks.begin(), ticks.begin() + 4096);
  expected.insert(expected.end(), ticks.begin() + 8192, ticks.end());
  SessionReader reader(file, SessionReader::Damage::kSalvaged);
  CHECK(reader.ticks() == expected.size());
  CHECK(reader.dropped() == 3);
  CHECK(reader.lost_bytes() > 100'000);
  CHECK(same(rest_of(reader), expected));
  // Without the index as well.
  put_bytes(file, bytes.substr(0, bytes.size() - 1));
  SessionReader scanned(file, SessionReader::Damage::kSalvaged);
  CHECK(same(rest_of(scanned), expected));
}

TEST_CASE("what is salvaged does not go back in time") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  const std::vector<TickRecord> ticks = random_ticks(9000, 7);
  write(file, ticks);
  const std::string bytes = bytes_of(file);
  std::size_t end = 0;
  const auto next_frame = [&] {
    const std::size_t size = zstd_frame_size(std::as_bytes(std::span(bytes)).subspan(end));
    return bytes.substr(std::exchange(end, end + size), size);
  };
  const std::string header = next_frame();
  const std::string first = next_frame();
  const std::string second = next_frame();
  put_bytes(file, header + second + first);
  SessionReader reader(file, SessionReader::Damage::kSalvaged);
  CHECK(reader.lost_bytes() == first.size());
  CHECK(same(rest_of(reader), {ticks.begin() + 4096, ticks.begin() + 8192}));
}

TEST_CASE("parts of two sessions make none") {
  const TemporaryDirectory directory;
  write(directory.file("a"), random_ticks(3, 1));
  const std::string a = bytes_of(directory.file("a"));
  const auto frame_after = [&](const std::string& bytes, std::size_t from) {
    return bytes.find("\x28\xB5\x2F\xFD", from);
  };
  const std::size_t chunk = frame_after(a, 4);
  const std::size_t footer = frame_after(a, chunk + 4);
  // Another session whose chunk has the same size.
  std::string other;
  for (std::uint64_t seed = 2; other.size() != footer - chunk; ++seed) {
    REQUIRE(seed < 1000);
    write(directory.file("b"), random_ticks(3, seed));
    const std::string b = bytes_of(directory.file("b"));
    other = b.substr(chunk, frame_after(b, chunk + 4) - chunk);
  }
  Scratch mixed(a.substr(0, chunk) + other + a.substr(footer));
  CHECK_FALSE(mixed.read());
  CHECK(mixed.why == "bad: byte " + std::to_string(chunk) +
                         ": damaged: a chunk does not fit the index's digest of it");
}

TEST_CASE("what is no session is called so") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x");
  put_bytes(file, "");
  CHECK_THROWS_WITH(SessionReader(file), file + ": byte 0: not a session: no zstd frame");
  put_bytes(file, "# t\tx\ty\tz\n");
  CHECK_THROWS_WITH(SessionReader(file), file + ": byte 0: not a session: no zstd frame");
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
