// The motion of a hand, read from a session, to be replayed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/session/session.hpp"

namespace hapgrid {

struct RecordedTick {
  std::uint64_t number = 0;  ///< ascending; ticks whose numbers are skipped were missed
  Vec3 hip{};                ///< in the box's axes and the model's unit; it need not be finite
  bool clutch = false;
  bool stalled = false;
  bool reset = false;
  bool next = false;
  bool begins = false;
  std::uint32_t slew_ns = 0;  ///< as in TickRecord
};

struct Recording {
  SessionHeader header;
  std::string ended_early;          ///< SessionReader::ended_early()
  std::vector<RecordedTick> ticks;  ///< at least one
};

/// The most bytes of memory for the ticks of a recording: some 7 h at 1 kHz.
inline constexpr std::uint64_t kRecordingLimit = 1'000'000'000;

/// Reads a session. "-" is standard input.
/// @throw std::system_error; FormatError "NAME: byte N: ..."; Error when there is no tick, or when
/// the ticks need more than `limit` bytes.
Recording load_recording(const std::string& name, std::uint64_t limit = kRecordingLimit);

}  // namespace hapgrid
