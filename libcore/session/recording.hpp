// The motion of a hand, read from a session or from a text log of play, to be replayed.
#pragma once

#include <cstdint>
#include <optional>
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
  std::optional<SessionHeader> header;  ///< of a session; a text has none
  std::string ended_early;              ///< SessionReader::ended_early(); empty for a text
  std::vector<RecordedTick> ticks;      ///< at least one
};

/// The most bytes of memory for the ticks of a recording: some 7 h at 1 kHz.
inline constexpr std::uint64_t kRecordingLimit = 1'000'000'000;

/// Reads a session or a text; the content tells which. "-" is standard input.
///
/// A text has a first line "# t x y z ...", as play --log writes it: names of
/// columns, separated by tabs. Only t (seconds) and x, y, z are read. A tick's number is
/// t * text_rate_hz, rounded. A text has no clutch, stalled, reset, next and begins: they are
/// false.
/// @throw std::system_error; FormatError "NAME: byte N: ..." for a session; Error "NAME: line N:
/// ..." for a text; Error when there is no tick, or when the ticks need more than `limit` bytes.
Recording load_recording(const std::string& name, double text_rate_hz,
                         std::uint64_t limit = kRecordingLimit);

}  // namespace hapgrid
