#include "tools/play/log.hpp"

#include <algorithm>
#include <span>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kWriteBytes = 1 << 16;
constexpr std::size_t kBeforeState = 10;  // t, the HIP, the model's force and the one that was sent

}  // namespace

TextLog::TextLog(const std::string& file, const GridSpec& spec, const Fields& fields,
                 double rate_hz, std::size_t capacity)
    : output_(file, false),
      spec_(spec),
      fields_(fields),
      rate_hz_(rate_hz),
      columns_(kBeforeState + spec.state_size),
      capacity_(capacity) {
  numbers_.resize(capacity * columns_);
  if (spec.stored.energy)
    energies_.resize(capacity);
  else if (fields.has_energy())
    positions_.resize(capacity);
  levels_.resize(capacity);
  snaps_.resize(capacity);
  text_ = "# t\tx\ty\tz\tforce_x\tforce_y\tforce_z\tsent_x\tsent_y\tsent_z";
  for (int i = 0; i < 8; ++i) text_ += format("\tl{}", i);
  for (std::size_t i = 0; i < spec.state_size; ++i) text_ += format("\ts{}", i);
  if (fields.has_energy()) text_ += "\tenergy";
  if (fields.has_own_energy()) text_ += "\town_energy";
  text_ += "\tsnap\n";
  output_.write(text_);
}

void TextLog::add(const Tick& tick) noexcept {
  double* to = numbers_.data() + size_ * columns_;
  *to++ = static_cast<double>(tick.number) / rate_hz_;
  for (const double x : tick.hip) *to++ = x;
  for (const double f : tick.raw_force) *to++ = f;
  for (const double f : tick.force.force) *to++ = f;
  for (const double s : tick.traversal.state()) *to++ = s;
  if (!energies_.empty()) energies_[size_] = tick.traversal.row()[spec_.energy_offset()];
  if (!positions_.empty()) positions_[size_] = tick.traversal.position();
  snaps_[size_] = tick.step.snapped ? 1 : 0;
  levels_[size_++] = tick.traversal.levels();
}

void TextLog::flush() {
  text_.clear();
  for (std::size_t row = 0; row < size_; ++row) {
    const std::span<const double> numbers(numbers_.data() + row * columns_, columns_);
    const std::span<const double> state = numbers.subspan(kBeforeState, spec_.state_size);
    for (std::size_t i = 0; i < kBeforeState; ++i) append(numbers[i], i == 0 ? "" : "\t");
    for (const Level level : levels_[row]) text_ += '\t' + std::to_string(level);
    for (const double s : state) append(s, "\t");
    if (!energies_.empty()) append(energies_[row], "\t");
    if (!positions_.empty()) append(fields_.energy(positions_[row], state), "\t");
    if (fields_.has_own_energy()) append(fields_.own_energy(state), "\t");
    text_ += snaps_[row] != 0 ? "\t1\n" : "\t0\n";
    if (text_.size() < kWriteBytes) continue;
    output_.write(text_);
    text_.clear();
  }
  output_.write(text_);
  size_ = 0;
}

void TextLog::append(double value, const char* separator) {
  text_ += separator;
  append_digits17(text_, value);
}

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
