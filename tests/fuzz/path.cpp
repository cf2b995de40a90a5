// Paths of the HIP.
#include "libcore/device/path.hpp"

#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::refusable([&] { parse_path(fuzz::text_of({data, size}), "fuzz"); });
  return 0;
}
