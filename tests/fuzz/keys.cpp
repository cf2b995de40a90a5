// What a terminal sends: wherever keys lead, the HIP stays in its box.
#include "libcore/device/keyboard.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const KeyboardOptions options{
      .start = {0, 0, 0}, .low = {-1, -2, 0}, .high = {1, 2, 3}, .step = 0.1};
  KeyReader keys(options);
  for (const std::uint8_t byte : std::span(data, size)) {
    keys.take(byte);
    for (int a = 0; a < 3; ++a)
      if (!(keys.target()[a] >= options.low[a] && keys.target()[a] <= options.high[a]))
        throw std::logic_error("out of the box");
  }
  return 0;
}
