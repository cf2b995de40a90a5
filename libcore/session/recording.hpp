// The motion of a hand, read from a session or from a text log of play, to be replayed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libcore/session/session.hpp"

namespace hapgrid {

struct RecordedTick {
  std::uint64_t number = 0;  ///< ascending; what is skipped was missed
  Vec3 hip{};                ///< the box's axes, the model's unit; need not be finite
  bool clutch = false;
  bool stalled = false;
  bool reset = false;
  bool begins = false;
};

struct Recording {
  std::optional<SessionHeader> header;  ///< of a session; a text has none
  std::vector<RecordedTick> ticks;      ///< at least one
};

/// The most memory for the ticks of a recording: some 7 h at 1 kHz.
inline constexpr std::uint64_t kRecordingLimit = 1'000'000'000;

/// Reads a session or a text, whichever the content is. "-" is standard input.
///
/// A text has a first line "# t x y z ...", as play --log and stats --export write it: names of
/// columns, separated by tabs, of which t (seconds) and x, y, z are taken. A tick's number is
/// t * text_rate_hz, rounded. Clutch, stalled, reset and begins are not in a
/// text.
/// @throw std::system_error; FormatError "NAME: byte N: ..." for a session; Error "NAME: line N:
/// ..." for a text; Error when there is no tick, or more than `limit` bytes of them.
Recording load_recording(const std::string& name, double text_rate_hz,
                         std::uint64_t limit = kRecordingLimit);

}  // namespace hapgrid
