// Whether the mutator of shards gets past their digests: most of what it makes is refused, if it
// is, for what its messages say.
#include "libcore/shard/reader.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/unit/catch.hpp"

using namespace hapgrid;

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed);

/// Stands in for libFuzzer's: another byte in the middle.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t) {
  data[size / 2] ^= 0x55;
  return size;
}

namespace {

/// Why the chunks of a grid cannot be read; empty when they can.
std::string refusal(std::span<const std::uint8_t> shard) {
  const fuzz::MemoryFile memory(std::as_bytes(shard));
  try {
    for (const Section& section : open_sections({memory.name()})) {
      SectionReader reader(section);
      Chunk rows;
      for (std::size_t i = 0; i < section.chunks.size(); ++i) reader.read(i, rows);
    }
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

bool is_about_bytes(const std::string& refusal) {
  for (const char* word : {"digest", "hash", "zstd", "truncated", "Data corruption", "checksum"})
    if (refusal.find(word) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("a mutated shard keeps digests, sizes and frames that fit") {
  const std::string grid =
      read_text(HAPGRID_SOURCE_DIR "/tests/fuzz/corpus/shard/made-grid", 1 << 20);
  constexpr int kTimes = 400;
  int of_bytes = 0, fine = 0;
  for (unsigned seed = 1; seed <= kTimes; ++seed) {
    std::vector<std::uint8_t> bytes(grid.begin(), grid.end());
    bytes.resize(1 << 16);
    bytes.resize(LLVMFuzzerCustomMutator(bytes.data(), grid.size(), bytes.size(), seed * 7919));
    const std::string why = refusal(bytes);
    of_bytes += is_about_bytes(why);
    fine += why.empty();
  }
  CAPTURE(of_bytes, fine);
  CHECK(of_bytes < kTimes / 3);  // one in eight is of the file's bytes; some lack their footer
  CHECK(fine > kTimes / 20);
}
