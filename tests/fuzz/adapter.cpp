// What an adapter says: a greeting, then states, each of its full size. What is accepted must be
// safe to use.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "libcore/device/process_messages.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

namespace {

/// The next message, as recv() gives it. @return its bytes
template <class Message>
std::size_t take(std::span<const std::uint8_t>& bytes, Message& message) {
  const std::size_t size = std::min(bytes.size(), sizeof message);
  if (size > 0) std::memcpy(&message, bytes.data(), size);
  bytes = bytes.subspan(size);
  return size;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> bytes(data, size);
  hapgrid_device_greeting greeting{};
  if (!greeting_flaw(greeting, take(bytes, greeting)).empty()) return 0;
  const DeviceInfo info = device_info(greeting, "fuzz");
  double widest = 0;
  for (int a = 0; a < 3; ++a) widest = std::max(widest, info.high[a] - info.low[a]);
  const bool usable =
      widest >= 1e-3 && widest <= 20 && info.max_force <= 1000 && greeting.rate >= 20;
  if (!usable || info.name.empty() || info.name.find('\x1b') != info.name.npos) std::abort();
  double time = -1;
  for (std::uint32_t number = 1; !bytes.empty(); ++number) {
    hapgrid_device_state state{};
    if (state_flaw(greeting, state, take(bytes, state), number, time) != StateFlaw::kNone) continue;
    for (int a = 0; a < 3; ++a)
      if (!(std::abs(state.position[a]) < 20) || !std::isfinite(state.velocity[a])) std::abort();
    if (!(state.time >= time)) std::abort();
    time = state.time;
  }
  return 0;
}
