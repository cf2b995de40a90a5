// The motion of a hand, read from a session, to be replayed.
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/device/device.hpp"
#include "libcore/session/reader.hpp"

namespace hapgrid {

/// The most bytes of memory for the ticks of a recording: some 6 h at 1 kHz.
inline constexpr std::uint64_t kRecordingLimit = 2'500'000'000;

/// Reads a session to its end: what the hand did in each tick, as a ReplayDevice takes it. The
/// positions are those of the HIP; they need not be finite.
/// @throw std::system_error; Error when there is no tick, or when the ticks need more than `limit`
/// bytes.
std::vector<DeviceInput> load_recording(SessionReader& session,
                                        std::uint64_t limit = kRecordingLimit);

}  // namespace hapgrid
