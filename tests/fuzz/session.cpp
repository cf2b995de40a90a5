// Sessions, whole and cut. The mutator changes the messages in one and keeps their zstd frames
// right (mutate.hpp).
#include "libcore/session/reader.hpp"
#include "libcore/session/recording.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutate.hpp"
#include "tools/stats/log_statistics.hpp"

using namespace hapgrid;
using namespace hapgrid::fuzz;

namespace {

void read_ticks(InputFile file) {
  SessionReader reader(std::move(file));
  SessionStatistics statistics;
  HandEnergy energy(reader.header());
  for (int times = 0; times < 2; ++times, reader.rewind())
    for (std::vector<TickRecord> ticks; reader.next(ticks);)
      for (const TickRecord& tick : ticks) {
        statistics.add(tick);
        energy.add(tick);
      }
}

void read_session(std::span<const std::byte> bytes) {
  refusable([&] { read_ticks({MemoryFile(bytes).take(), "session"}); });
  refusable([&] {
    const MemoryFile memory(bytes);
    SessionReader reader(memory.name());
    load_recording(reader);
  });
}

/// A session has no footer.
void fit_footer(Words& /*footer*/, std::span<const Framed> /*before*/) {}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read_session(std::as_bytes(std::span(data, size)));
  return 0;
}

HAPGRID_FUZZ_MESSAGES(fit_footer)
