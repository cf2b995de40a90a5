// Frames: the bytes do not depend on what the thread has coded before.
#include "libcore/base/zstd_frame.hpp"

#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

using Words = std::vector<std::uint64_t>;

/// Noise, a slope, runs of few bytes, or all of them in turns: what zstd codes each in its own way.
Words draw_content(std::mt19937_64& random) {
  Words words(1 + random() % 20000);
  const std::uint64_t kind = random() % 4;
  for (std::size_t i = 0; i < words.size(); ++i) {
    switch (kind == 3 ? i / 100 % 3 : kind) {
      case 0:
        words[i] = random();
        break;
      case 1:
        words[i] = 3 * i;
        break;
      default:
        words[i] = i / 50 % 4;
    }
  }
  return words;
}

std::vector<std::byte> encode(const Words& content, int level) {
  ZstdFrameEncoder encoder(level);
  const auto frame = encoder.encode(std::as_bytes(std::span(content)));
  return {frame.begin(), frame.end()};
}

}  // namespace

TEST_CASE("a frame is the same in a thread that has coded others and in a fresh one") {
  std::mt19937_64 random(20061);
  for (int i = 0; i < 100; ++i) {
    CAPTURE(i);
    const Words content = draw_content(random);
    const int level = static_cast<int>(random() % 5) - 1;
    const std::vector<std::byte> frame = encode(content, level);
    std::vector<std::byte> fresh;
    std::thread([&] { fresh = encode(content, level); }).join();
    REQUIRE(frame == fresh);
    Words decoded;
    decode_zstd_frame(frame, content.size() * sizeof(std::uint64_t), "frame", decoded);
    REQUIRE(decoded == content);
  }
}
