// Sessions as bytes, whole and salvaged.
#include "tests/fuzz/read_session.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  hapgrid::fuzz::read_session(std::as_bytes(std::span(data, size)));
  return 0;
}
