// What arrives byte by byte from another program, a socket or a terminal. The bytes are given to
// every reader of such a stream; what is accepted must be safe to use.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "libcore/device/keyboard.hpp"
#include "libcore/device/process_device.hpp"
#include "libcore/scene/stream.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tools/view/imd_protocol.hpp"

using namespace hapgrid;
using Bytes = std::span<const std::uint8_t>;

namespace {

/// The next message, as recv() gives it. @return its bytes
template <class Message>
std::size_t take(Bytes& bytes, Message& message) {
  const std::size_t size = std::min(bytes.size(), sizeof message);
  if (size > 0) std::memcpy(&message, bytes.data(), size);
  bytes = bytes.subspan(size);
  return size;
}

/// What an adapter says: a greeting, then states, each of its full size.
void take_adapter(Bytes bytes) {
  hapgrid_device_greeting greeting{};
  if (!greeting_flaw(greeting, take(bytes, greeting)).empty()) return;
  const DeviceInfo info = device_info(greeting, "fuzz");
  double widest = 0;
  for (int a = 0; a < 3; ++a) widest = std::max(widest, info.high[a] - info.low[a]);
  const bool usable =
      widest >= 1e-3 && widest <= 20 && info.max_force <= 1000 && greeting.rate >= 20;
  if (!usable || info.name.empty() || info.name.find('\x1b') != info.name.npos) std::abort();
  double time = -1;
  for (std::uint32_t number = 1; !bytes.empty(); ++number) {
    hapgrid_device_state state{};
    if (state_flaw(greeting, state, take(bytes, state), number, time) != AdapterFault::kNone)
      continue;
    for (int a = 0; a < 3; ++a)
      if (!(std::abs(state.position[a]) < 20)) std::abort();
    if (!(state.time >= time)) std::abort();
    time = state.time;
  }
}

/// What an IMD client says. The first byte: how long the pieces are in which the rest comes; where
/// they are cut must not matter.
void take_imd(Bytes all) {
  const std::size_t piece = 1 + all[0];
  const auto bytes = std::as_bytes(all.subspan(1));
  ImdListener whole(5);
  whole.read(bytes);
  ImdListener listener(5);
  for (std::size_t i = 0; i < bytes.size(); i += piece)
    listener.read(bytes.subspan(i, std::min(piece, bytes.size() - i)));
  if (listener.state() != whole.state()) throw std::logic_error("the pieces matter");
}

/// What a terminal sends: wherever keys lead, the HIP stays in its box.
void take_keys(Bytes bytes) {
  const Box box{{-1, -2, 0}, 1, {3, 5, 4}};
  KeyReader keys(box, {0, 0, 0}, 0.1);
  for (const std::uint8_t byte : bytes) {
    keys.read(byte);
    for (int a = 0; a < 3; ++a)
      if (!(keys.target()[a] >= box.origin[a] && keys.target()[a] <= box.high()[a]))
        throw std::logic_error("out of the box");
  }
}

/// Frames, as a viewer reads them. Their messages have no checksum.
void take_frames(Bytes bytes) {
  fuzz::refusable([&] {
    SceneReader reader(fuzz::MemoryFile(std::as_bytes(bytes)).take(), "frames");
    for (Frame frame; reader.next(frame);) {
    }
  });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Bytes bytes(data, size);
  take_adapter(bytes);
  take_imd(bytes);
  take_keys(bytes);
  take_frames(bytes);
  return 0;
}
