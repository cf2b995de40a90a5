#include "tools/play/log.hpp"

#include <algorithm>

#include "libcore/base/format.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

Log::Log(const std::string& file, const PlayedGrid& grid, double rate_hz, bool paced,
         std::size_t ticks, const PlayedWith& with) {
  if (file.empty()) return;
  if (is_session_name(file)) {
    session_.emplace(file, session_header(grid.spec(), grid.digest, rate_hz, with), paced);
    return;
  }
  // A paced play must not write before its end, so its storage has room for all ticks. Without
  // deadlines the log is written whenever the storage is full.
  constexpr std::size_t kChunk = 4096;
  text_.emplace(file, grid.spec(), grid.fields, rate_hz, paced ? ticks : std::min(ticks, kChunk));
}

void Log::add(const Tick& tick) {
  if (session_) session_->add(tick_record(tick));
  if (!text_) return;
  if (text_->full()) text_->flush();
  text_->add(tick);
}

void Log::finish() {
  if (session_) {
    const std::uint64_t recorded = session_->finish();
    if (session_->dropped() > 0)
      say("play", format("the log has {} ticks, {} were dropped: the disk was slow", recorded,
                         session_->dropped()));
  }
  if (!text_) return;
  text_->flush();
  text_->commit();
}

}  // namespace hapgrid
