#include "libcore/session/recording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <istream>
#include <streambuf>
#include <string_view>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/session/reader.hpp"

namespace hapgrid {

/// A buffer for std::istream that reads from the file's beginning. The file must outlive it; a
/// failure to read is an exception, of which the stream makes badbit.
class InputBuffer : public std::streambuf {
 public:
  explicit InputBuffer(const InputFile& file) : file_(&file) {}

 private:
  int_type underflow() override {
    const std::size_t count = file_->read(offset_, std::as_writable_bytes(std::span(buffer_)));
    if (count == 0) return traits_type::eof();
    offset_ += count;
    setg(buffer_.data(), buffer_.data(), buffer_.data() + count);
    return traits_type::to_int_type(buffer_[0]);
  }

  const InputFile* file_;
  std::uint64_t offset_ = 0;
  std::array<char, 1 << 16> buffer_;
};

namespace {

void require_room(const std::string& name, std::uint64_t ticks, std::uint64_t limit) {
  if (ticks > limit / sizeof(RecordedTick))
    throw Error(format("{}: {} ticks or more need {} bytes of memory, the limit is {}", name, ticks,
                       ticks * sizeof(RecordedTick), limit));
}

Recording load_session(InputFile file, std::uint64_t limit) {
  SessionReader reader(std::move(file));
  Recording recording{reader.header(), {}, {}};
  const auto bit = [&](const char* name) -> std::uint32_t {
    const std::size_t flag = reader.header().flag(name);
    return flag == kMaxFlags ? 0 : std::uint32_t{1} << flag;
  };
  const std::uint32_t clutch = bit(kClutchFlag);
  const std::uint32_t stalled = bit(kStalledFlag);
  const std::uint32_t reset = bit(kResetFlag);
  const std::uint32_t next = bit(kNextFlag);
  const std::uint32_t begins = bit(kBeginsFlag);
  for (std::vector<TickRecord> chunk; reader.next(chunk);) {
    require_room(reader.name(), recording.ticks.size() + chunk.size(), limit);
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

/// The cell `column` of a line that is separated by tabs; false when there are fewer.
bool find_cell(std::string_view line, std::size_t column, std::string_view& cell) {
  for (;; --column) {
    const std::size_t tab = std::min(line.find('\t'), line.size());
    cell = line.substr(0, tab);
    if (column == 0) return true;
    if (tab == line.size()) return false;
    line.remove_prefix(tab + 1);
  }
}

class TextLog {
 public:
  TextLog(const InputFile& file, double rate_hz)
      : name_(file.name()), buffer_(file), rate_hz_(rate_hz) {
    if (!std::getline(input_, line_) || !line_.starts_with("# "))
      fail("no session, and no '# t x y z ...' as play --log writes it");
    line_.erase(0, 2);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      std::string_view cell;
      while (find_cell(line_, columns_[i], cell) && cell != kNames[i]) ++columns_[i];
      if (cell != kNames[i]) fail(format("no column '{}'", kNames[i]));
    }
  }

  bool next(RecordedTick& tick) {
    if (!std::getline(input_, line_)) {
      if (input_.bad()) throw Error(format("{}: cannot be read", name_));
      return false;
    }
    ++number_;
    const double t = value(0);
    const double ticks = std::round(t * rate_hz_);
    if (!(ticks >= 0 && ticks < 0x1p53))
      fail(format("t = {} at {} Hz is no tick's number", to_text(t), to_text(rate_hz_)));
    const auto number = static_cast<std::uint64_t>(ticks);
    if (number_ > 2 && number <= tick.number)
      fail(format("t = {} at {} Hz is tick {}, and the line before is tick {}", to_text(t),
                  to_text(rate_hz_), number, tick.number));
    tick = {.number = number, .hip = {value(1), value(2), value(3)}};
    return true;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(format("{}: line {}: {}", name_, number_, what));
  }

 private:
  static constexpr std::array<std::string_view, 4> kNames{"t", "x", "y", "z"};

  double value(std::size_t i) const {
    std::string_view cell;
    double result = 0;
    const bool found = find_cell(line_, columns_[i], cell);
    const char* end = cell.data() + cell.size();
    const auto read = std::from_chars(cell.data(), end, result);
    if (!found || read.ec != std::errc() || read.ptr != end)
      fail(format("column {}: {}", kNames[i],
                  found ? format("'{}' is no number", printable_line(cell, 40)) : "not there"));
    return result;
  }

  std::string name_;
  InputBuffer buffer_;
  std::istream input_{&buffer_};
  double rate_hz_;
  std::string line_;
  std::size_t number_ = 1;
  std::array<std::size_t, 4> columns_{};
};

Recording load_text(const InputFile& file, double rate_hz, std::uint64_t limit) {
  TextLog log(file, rate_hz);
  Recording recording;
  for (RecordedTick tick; log.next(tick);) {
    require_room(file.name(), recording.ticks.size() + 1, limit);
    recording.ticks.push_back(tick);
  }
  if (recording.ticks.empty()) log.fail("no ticks after the names of the columns");
  return recording;
}

}  // namespace

Recording load_recording(const std::string& name, double text_rate_hz, std::uint64_t limit) {
  InputFile file(name, InputFile::Content::kFramesOrText);
  return starts_with_zstd_frame(file) ? load_session(std::move(file), limit)
                                      : load_text(file, text_rate_hz, limit);
}

}  // namespace hapgrid
