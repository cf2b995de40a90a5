// Sessions, whole and salvaged. The mutator changes the messages in one and keeps what stands
// around them right (mutate.hpp).
#include "libcore/session/format.hpp"
#include "libcore/session/reader.hpp"
#include "libcore/session/recording.hpp"
#include "libcore/session/statistics.hpp"
#include "libcore/session/text.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutate.hpp"

using namespace hapgrid;
using namespace hapgrid::fuzz;

namespace {

void read_ticks(InputFile file, SessionReader::Damage damage) {
  SessionReader reader(std::move(file), damage);
  SessionStatistics statistics;
  std::string text;
  for (std::vector<TickRecord> ticks; reader.next(ticks);)
    for (const TickRecord& tick : ticks) {
      statistics.add(tick);
      text.clear();
      append_session_text(text, reader.header(), tick);
    }
  reader.seek(reader.tick_at(reader.header().time_of(reader.first_tick() / 2 + 1)));
  std::vector<TickRecord> ticks;
  reader.next(ticks);
}

void read_session(std::span<const std::byte> bytes) {
  for (const auto damage : {SessionReader::Damage::kRefused, SessionReader::Damage::kSalvaged})
    refusable([&] { read_ticks({MemoryFile(bytes).take(), "session"}, damage); });
  refusable([&] {
    const MemoryFile memory(bytes);
    load_recording(memory.name(), 1000);
  });
}

/// The places and the digests of the chunks, and the footer's own digest.
void fit_footer(Words& words, std::span<const Framed> before) {
  SessionFooter footer = decode_footer(words, before.size() + 1);
  if (before.empty()) return;
  footer.chunks.resize(before.size() - 1);
  std::vector<Digest> digests;
  for (std::size_t i = 0; i < before.size(); ++i) {
    digests.push_back(before[i].digest);
    if (i == 0) continue;
    ChunkEntry& chunk = footer.chunks[i - 1];
    chunk.offset = before[i].offset;
    chunk.size = before[i].size;
    chunk.digest = before[i].digest;
  }
  footer.digest = digest_of(std::as_bytes(std::span(digests)));
  words = encode_footer(footer);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read_session(std::as_bytes(std::span(data, size)));
  return 0;
}

HAPGRID_FUZZ_MESSAGES(fit_footer)
