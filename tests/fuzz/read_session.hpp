// All that is read of a session: for the two targets that get to it from bytes and from messages.
#pragma once

#include "libcore/session/reader.hpp"
#include "libcore/session/recording.hpp"
#include "libcore/session/statistics.hpp"
#include "libcore/session/text.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace hapgrid::fuzz {

inline void read_ticks(InputFile file, SessionReader::Damage damage) {
  SessionReader reader(std::move(file), damage);
  SessionStatistics statistics;
  std::string text;
  for (std::vector<TickRecord> ticks; reader.next(ticks);)
    for (const TickRecord& tick : ticks) {
      statistics.add(tick);
      text.clear();
      append_session_text(text, reader.header(), tick);
    }
  reader.seek(reader.tick_at(reader.header().time_of(reader.first_tick() / 2 + 1)));
  std::vector<TickRecord> ticks;
  reader.next(ticks);
}

inline void read_session(std::span<const std::byte> bytes) {
  for (const auto damage : {SessionReader::Damage::kRefused, SessionReader::Damage::kSalvaged})
    refusable([&] { read_ticks({MemoryFile(bytes).take(), "session"}, damage); });
  refusable([&] {
    const MemoryFile memory(bytes);
    load_recording(memory.name(), 1000);
  });
}

}  // namespace hapgrid::fuzz
