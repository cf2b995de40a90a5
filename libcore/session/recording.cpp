#include "libcore/session/recording.hpp"

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/session/reader.hpp"

namespace hapgrid {

Recording load_recording(const std::string& name, std::uint64_t limit) {
  SessionReader reader(name);
  Recording recording{reader.header(), {}, {}};
  const auto bit = [&](const char* flag_name) -> std::uint32_t {
    const std::size_t flag = reader.header().flag(flag_name);
    return flag == kMaxFlags ? 0 : std::uint32_t{1} << flag;
  };
  const std::uint32_t clutch = bit(kClutchFlag);
  const std::uint32_t stalled = bit(kStalledFlag);
  const std::uint32_t reset = bit(kResetFlag);
  const std::uint32_t next = bit(kNextFlag);
  const std::uint32_t begins = bit(kBeginsFlag);
  for (std::vector<TickRecord> chunk; reader.next(chunk);) {
    const std::uint64_t ticks = recording.ticks.size() + chunk.size();
    if (ticks > limit / sizeof(RecordedTick))
      throw Error(format("{}: {} ticks or more need {} bytes of memory, the limit is {}",
                         reader.name(), ticks, ticks * sizeof(RecordedTick), limit));
    for (const TickRecord& tick : chunk)
      recording.ticks.push_back({tick.number, tick.hip, (tick.flags & clutch) != 0,
                                 (tick.flags & stalled) != 0, (tick.flags & reset) != 0,
                                 (tick.flags & next) != 0, (tick.flags & begins) != 0,
                                 tick.slew_ns});
  }
  recording.ended_early = reader.ended_early();
  if (recording.ticks.empty()) throw Error(without_ticks(reader));
  return recording;
}

}  // namespace hapgrid
