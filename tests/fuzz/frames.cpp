// Streams of frames, as a viewer reads them. Their messages have no checksum.
#include "libcore/scene/stream.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::refusable([&] {
    SceneReader reader(fuzz::MemoryFile(std::as_bytes(std::span(data, size))).take(), "frames");
    for (Frame frame; reader.next(frame);) {
    }
  });
  return 0;
}
