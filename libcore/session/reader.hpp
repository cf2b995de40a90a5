// Reading a session, chunk by chunk. Everything in a file is checked before it is used.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/session/format.hpp"

namespace hapgrid {

/// Whether a file begins with the header of a session. No more is read than a header can have.
/// @throw std::system_error
bool is_session(const InputFile& file);

/// A session ends where its file does. When play was killed, or the disk has damaged the file, the
/// session ends before the first zstd frame that is cut or damaged; ended_early() says so then. The
/// memory is that of one chunk.
class SessionReader {
 public:
  /// Reads the header. "-" is standard input.
  /// @throw std::system_error; FormatError "NAME: byte N: ..."
  explicit SessionReader(const std::string& name) : SessionReader(InputFile(name)) {}
  explicit SessionReader(InputFile file);

  /// The name for messages: "standard input" for "-".
  const std::string& name() const { return file_.name(); }
  const SessionHeader& header() const { return header_; }

  /// Reads the ticks of the next chunk, at least one. False at the session's end.
  /// @throw std::system_error
  bool next(std::vector<TickRecord>& ticks);
  /// The following next() reads the first chunk.
  void rewind();

  /// After next() has returned false: where and why the session ended before its file,
  /// "byte 4711 of 9000: a zstd frame is cut". Empty when the session is whole.
  const std::string& ended_early() const { return ended_early_; }
  /// Ticks of the play up to the last chunk read that are not in the session, because the disk was
  /// too slow.
  std::uint64_t dropped() const { return dropped_; }

 private:
  void read_header();
  /// @throw FormatError without file and offset
  void read_chunk(std::vector<TickRecord>& ticks);
  /// The zstd frame at offset_, or nothing when no whole one of `content` bytes at most is there.
  std::span<const std::byte> frame(std::uint64_t content);

  InputFile file_;
  std::vector<std::byte> buffer_;
  MessageWords message_;
  SessionHeader header_;
  std::uint64_t header_end_ = 0;
  std::uint64_t offset_ = 0;                // of the next zstd frame
  std::optional<std::uint64_t> last_tick_;  // its number, of the chunks before
  std::uint64_t dropped_ = 0;
  std::string ended_early_;
};

/// The text of an Error for a session that has no tick.
std::string without_ticks(const SessionReader& session);

}  // namespace hapgrid
