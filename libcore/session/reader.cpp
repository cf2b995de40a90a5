#include "libcore/session/reader.hpp"

#include <algorithm>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

bool is_session(const InputFile& file) {
  std::vector<std::byte> start(
      std::min<std::uint64_t>(zstd_frame_bound(kHeaderLimit), file.size()));
  start.resize(file.read(0, start));
  start.resize(zstd_frame_size(start));
  MessageWords message;
  try {
    decode_zstd_frame(start, kHeaderLimit, "session", message);
    return is_header(message);
  } catch (const FormatError&) {
    return false;
  }
}

SessionReader::SessionReader(InputFile file) : file_(std::move(file)) {
  try {
    read_header();
  } catch (const FormatError& e) {
    throw FormatError(format("{}: byte 0: {}", file_.name(), e.what()));
  }
  header_end_ = offset_;
}

std::span<const std::byte> SessionReader::frame(std::uint64_t content) {
  const std::uint64_t most =
      std::min<std::uint64_t>(zstd_frame_bound(content), file_.size() - offset_);
  if (buffer_.size() < most) buffer_.resize(most);
  const std::size_t count = file_.read(offset_, std::span(buffer_).first(most));
  return {buffer_.data(), zstd_frame_size(std::span(buffer_).first(count))};
}

void SessionReader::read_header() {
  if (!starts_with_zstd_frame(file_)) throw FormatError("not a session: no zstd frame");
  const std::span<const std::byte> bytes = frame(kHeaderLimit);
  if (bytes.empty()) throw FormatError("not a session, or its header is cut");
  decode_zstd_frame(bytes, kHeaderLimit, "session", message_);
  header_ = decode_header(message_);
  offset_ = bytes.size();
}

void SessionReader::read_chunk(std::vector<TickRecord>& ticks) {
  const std::span<const std::byte> bytes = frame(kChunkLimit);
  if (bytes.empty()) throw FormatError("a zstd frame is cut");
  decode_zstd_frame(bytes, kChunkLimit, "session", message_);
  const std::uint64_t dropped = decode_ticks(message_, ticks);
  if (last_tick_ && ticks.front().number <= *last_tick_)
    throw FormatError(format("damaged: tick {} after tick {}", ticks.front().number, *last_tick_));
  dropped_ = dropped;
  last_tick_ = ticks.back().number;
  offset_ += bytes.size();
}

bool SessionReader::next(std::vector<TickRecord>& ticks) {
  if (offset_ >= file_.size() || !ended_early_.empty()) return false;
  try {
    read_chunk(ticks);
    return true;
  } catch (const FormatError& e) {
    ended_early_ = format("byte {} of {}: {}", offset_, file_.size(), e.what());
    return false;
  }
}

std::string without_ticks(const SessionReader& session) {
  return session.ended_early().empty()
             ? format("{}: a session without a tick", session.name())
             : format("{}: a session without a tick, which ended early at {}", session.name(),
                      session.ended_early());
}

void SessionReader::rewind() {
  offset_ = header_end_;
  last_tick_.reset();
  dropped_ = 0;
  ended_early_.clear();
}

}  // namespace hapgrid
