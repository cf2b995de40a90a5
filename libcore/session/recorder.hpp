// From the haptic loop to a session's file.
//
// Problem. The loop must never wait for a disk, nor for a compressor. In a paced play the loop
// copies each tick into a ring that was allocated before. A slow thread looks into the ring every
// 20 ms, compresses and writes; the loop does not wake it, since that would be a system call. When
// the ring is full because the disk is slow, ticks are dropped and counted. A play without a pace
// has no deadlines: it writes every tick itself.
//
// add() takes some 0.1 us, the slow thread 1 us a tick.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <thread>

#include "libcore/base/spsc_ring.hpp"
#include "libcore/session/writer.hpp"

namespace hapgrid {

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
