// What an IMD client says. The first byte: the version, and how long the pieces are in which the
// rest comes; where the pieces are cut must not matter.
#include <algorithm>

#include "libcore/scene/imd_protocol.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const int version = data[0] & 1 ? 3 : 2;
  const std::size_t piece = 1 + (data[0] >> 1);
  const auto bytes = std::as_bytes(std::span(data + 1, size - 1));
  ImdListener whole(version, 5);
  whole.take(bytes);
  ImdListener listener(version, 5);
  for (std::size_t i = 0; i < bytes.size(); i += piece)
    listener.take(bytes.subspan(i, std::min(piece, bytes.size() - i)));
  if (listener.state() != whole.state()) throw std::logic_error("the pieces matter");
  return 0;
}
