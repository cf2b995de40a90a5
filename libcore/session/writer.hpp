// Writing a session: a header, then chunks of ticks (schemas/session.capnp).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/session/format.hpp"

namespace hapgrid {

/// A session cannot be repeated: the hand was there once. So it is written into its file chunk by
/// chunk, and the chunks that are written stay whatever happens: a session is whole at the end of
/// each chunk. An older file of that name is lost when the writer opens it.
class SessionWriter {
 public:
  /// Writes the header at once, into a file, a device or a pipe.
  /// @throw Error for an impossible header (SessionHeader::validate()); std::system_error
  SessionWriter(const std::string& name, const SessionHeader& header);
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  /// @param dropped the number of ticks so far that were not added, which the next chunk tells.
  /// @throw Error when the tick's number is not above the last one's; std::system_error
  void add(const TickRecord& tick, std::uint64_t dropped = 0);
  /// How many were added.
  std::uint64_t ticks() const { return ticks_; }

  /// Writes the last ticks, and waits until a regular file is on the disk. Called once.
  /// @throw std::system_error
  void finish(std::uint64_t dropped = 0);

 private:
  void write(const Message& message);
  void write_chunk(std::uint64_t dropped);

  std::string name_;
  FileDescriptor file_;
  // The slow thread has time, and a session is kept: zstd's own default.
  ZstdFrameEncoder frames_{3};
  std::vector<TickRecord> rows_;  // of the chunk that is being filled
  std::uint64_t ticks_ = 0;
  std::uint64_t last_ = 0;  // number
};

}  // namespace hapgrid
