// Logs of play as text.
#include "libcore/session/recording.hpp"

#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::refusable([&] {
    const fuzz::MemoryFile memory(std::as_bytes(std::span(data, size)));
    load_recording(memory.name(), 1000);
  });
  return 0;
}
