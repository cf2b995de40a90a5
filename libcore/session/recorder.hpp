// From the haptic loop to a session's file.
//
// Problem. The loop must never wait for a disk, nor for a compressor. In a paced play the loop
// copies each tick into a ring that was allocated before. A slow thread looks into the ring every
// 20 ms, compresses and writes; the loop does not wake it, since that would be a system call. When
// the ring is full because the disk is slow, ticks are dropped and counted. A play without a pace
// has no deadlines: it writes every tick itself.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/base/spsc_ring.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/session/format.hpp"

namespace hapgrid {

// Writing a session: a header, then chunks of ticks (schemas/session.capnp).

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
  void write(const MessageWords& message);
  void write_chunk(std::uint64_t dropped);

  std::string name_;
  FileDescriptor file_;
  // The slow thread has time, and a session is kept: zstd's own default.
  ZstdFrameEncoder frames_{3};
  std::vector<TickRecord> rows_;  // of the chunk that is being filled
  std::uint64_t ticks_ = 0;
  std::uint64_t last_ = 0;  // number
};

class SessionRecorder {
 public:
  /// @param paced whether ticks come in real time, header.rate_hz a second.
  /// @throw as SessionWriter
  SessionRecorder(const std::string& name, const SessionHeader& header, bool paced);
  /// Without finish() the last ticks are missing in the file (SessionWriter).
  ~SessionRecorder();
  SessionRecorder(const SessionRecorder&) = delete;
  SessionRecorder& operator=(const SessionRecorder&) = delete;

  /// False when the tick is dropped: the ring is full, or writing has failed, which finish()
  /// reports. Real-time safe in a paced play.
  bool add(const TickRecord& tick) noexcept;
  /// Ticks that add() dropped, because the disk was too slow or writing had failed.
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

  /// Writes what is left to the disk and returns the number of ticks in the session. Called once,
  /// after the last add(). @throw std::system_error, Error: the first failure
  std::uint64_t finish();

 private:
  void run(const std::stop_token& token);
  void drain();

  SessionWriter writer_;  // belongs to the slow thread while it runs
  std::exception_ptr failure_;
  std::atomic<bool> failed_{false};
  std::atomic<std::uint64_t> dropped_{0};
  std::optional<SpscRing<TickRecord>> ring_;  // paced only
  std::jthread slow_;                         // declared last: ends before what it uses
};

}  // namespace hapgrid
