#include "libcore/session/recording.hpp"

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

std::vector<DeviceInput> load_recording(SessionReader& session, std::uint64_t limit) {
  const auto bit = [&](const char* name) -> std::uint32_t {
    const std::size_t flag = session.header().flag(name);
    return flag == kMaxFlags ? 0 : std::uint32_t{1} << flag;
  };
  const std::uint32_t clutch = bit(kClutchFlag), stalled = bit(kStalledFlag),
                      reset = bit(kResetFlag), next = bit(kNextFlag), begins = bit(kBeginsFlag);
  std::vector<DeviceInput> inputs;
  std::uint64_t expected = 0;  // number of a tick, if none was missed
  for (std::vector<TickRecord> chunk; session.next(chunk);) {
    const std::uint64_t ticks = inputs.size() + chunk.size();
    if (ticks > limit / sizeof(DeviceInput))
      throw Error(format("{}: {} ticks or more need {} bytes of memory, the limit is {}",
                         session.name(), ticks, ticks * sizeof(DeviceInput), limit));
    if (inputs.empty()) expected = chunk.front().number;
    for (const TickRecord& tick : chunk) {
      inputs.push_back({.position = tick.hip,
                        .stalled = (tick.flags & stalled) != 0,
                        .clutch = (tick.flags & clutch) != 0,
                        .reset = (tick.flags & reset) != 0,
                        .next = (tick.flags & next) != 0,
                        .begins = (tick.flags & begins) != 0,
                        .missed = tick.number - expected,
                        .slew_ns = tick.slew_ns});
      expected = tick.number + 1;
    }
  }
  if (inputs.empty()) throw Error(without_ticks(session));
  return inputs;
}

}  // namespace hapgrid
