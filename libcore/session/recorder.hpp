// From the haptic loop to a session's file.
//
// Problem. The loop must never wait for a disk, nor for a compressor. Paced, a tick is copied into
// a ring that is allocated beforehand, and a slow thread looks into it every 20 ms, packs and
// writes; nobody wakes it, since that would be a system call in the loop. When the disk is slower
// than the ring is long, ticks are dropped and counted. A play without a pace has no deadlines: its
// ticks are written where they happen, and all of them are.
//
// add() takes some 0.1 us, the slow thread 1 us a tick (tests/bench/session.cpp).
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <thread>

#include "libcore/session/ring.hpp"
#include "libcore/session/writer.hpp"

namespace hapgrid {

/// How recording went, in ticks.
struct SessionCounts {
  std::uint64_t recorded = 0;
  std::uint64_t dropped = 0;  ///< the disk was too slow
};

class SessionRecorder {
 public:
  /// @param paced ticks come in real time, header.rate_hz a second.
  /// @throw as SessionWriter
  SessionRecorder(const std::string& name, const SessionHeader& header, bool paced);
  /// Without finish() what was recorded stays as NAME.part, as SessionWriter has it.
  ~SessionRecorder();
  SessionRecorder(const SessionRecorder&) = delete;
  SessionRecorder& operator=(const SessionRecorder&) = delete;

  /// False when the tick is dropped, for want of room or since writing has failed, which finish()
  /// will say. Paced: real-time safe.
  bool add(const TickRecord& tick) noexcept;
  /// Of add() so far.
  std::uint64_t dropped() const noexcept { return dropped_; }

  /// After the last tick: everything is on the disk, and the file appears. Once only.
  /// @throw std::system_error, Error: what has failed first, and where the rest is.
  SessionCounts finish();

 private:
  void run(const std::stop_token& token);
  void drain();

  SessionWriter writer_;  // the slow thread's while it runs
  std::exception_ptr failure_;
  std::atomic<bool> failed_{false};
  std::uint64_t dropped_ = 0;
  std::optional<SpscRing<TickRecord>> ring_;  // paced only
  std::jthread slow_;                         // declared last: ends before what it uses
};

}  // namespace hapgrid
