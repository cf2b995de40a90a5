// From the haptic loop to a viewer.
//
// Problem. The loop must never wait for a viewer, nor for the shape of a state, for which a model
// may need milliseconds. In a paced play the loop leaves each tick in a triple buffer. A slow
// thread takes the newest tick 60 times a second, completes it, and writes it.
// Frames that a viewer is too slow for are dropped and counted. A play without a pace has no
// deadlines: it writes each due tick of scripted time itself, so that the same play gives the same
// bytes.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <mutex>
#include <span>
#include <thread>

#include "libcore/base/file.hpp"
#include "libcore/base/triple_buffer.hpp"
#include "libcore/scene/scene.hpp"
#include "libcore/scene/stream.hpp"

namespace hapgrid {

/// The frames that were written to the file, and how that ended.
struct FrameCounts {
  std::uint64_t written = 0;
  std::uint64_t dropped = 0;  ///< due while the viewer or the slow thread was late
  bool closed = false;        ///< the viewer closed the pipe; nothing was written after that
  bool cut = false;           ///< the viewer stopped reading; the last message is cut
  bool lacking = false;       ///< `complete` did not return in time for the last frame
};

class FramePublisher {
 public:
  /// Sets the energy and the centres of a frame, which have their sizes, from the rest of it.
  using Complete = std::function<void(Frame&)>;

  /// @param output the file or pipe for frames.
  /// @param row_size numbers in each frame's row; the scene's state_size or more.
  /// @param complete called from the slow thread when paced.
  /// @param ticks_per_second how much scripted time a tick is, for a play without a pace.
  /// @param stop becomes nonzero in a signal's handler: then a play without a pace no longer waits
  /// for its viewer.
  /// Without finish() no file appears.
  /// @throw std::system_error
  FramePublisher(OutputFile output, const Scene& scene, std::size_t row_size, Complete complete,
                 bool paced, double ticks_per_second, const std::atomic<int>& stop);
  FramePublisher(const FramePublisher&) = delete;
  FramePublisher& operator=(const FramePublisher&) = delete;

  /// The frame of this tick: all of it must be set but what `complete` sets. Its vectors have their
  /// sizes already. Real-time safe.
  Frame& next() noexcept { return buffer_.back(); }
  /// The frame is filled. Paced: real-time safe. @throw std::system_error when not paced.
  void publish();

  /// Called after the last tick, which becomes the last frame. Waits at most a second for a slow
  /// viewer, and for `complete`. Where that does not return (FrameCounts::lacking), the slow thread
  /// is left behind: this object, and what `complete` uses, must then never be destroyed.
  /// @throw std::system_error, also what the slow thread threw
  FrameCounts finish();

 private:
  using GiveUp = std::function<bool()>;

  void run(const std::stop_token& token);
  /// Writes all of `message`, unless the viewer closes the pipe (counts_.closed). While the viewer
  /// reads no more, `give_up` is asked several times a second whether to leave the message cut
  /// (counts_.cut), so that nothing may be written behind it. @return whether all was written
  bool write(std::span<const std::byte> message, const GiveUp& give_up);
  void write_newest(const GiveUp& give_up, std::unique_lock<std::mutex>& lock);
  /// Whether more can be written to the file.
  bool open() const { return !counts_.closed && !counts_.cut && !counts_.lacking; }

  OutputFile output_;      // a file, or a viewer behind a pipe: slow, asleep or dead
  std::size_t piece_ = 0;  // bytes that can be written without waiting, once poll() has said so
  const Scene scene_;
  const Complete complete_;
  const bool paced_;
  const std::uint64_t ticks_per_frame_;  // without a pace
  const GiveUp stopped_;
  TripleBuffer<Frame> buffer_;
  // While the slow thread runs, the members from here on belong to it. It holds the mutex, but
  // while it sleeps and in complete_.
  std::mutex mutex_;
  SceneEncoder encoder_;
  Frame frame_;
  FrameCounts counts_;
  // Without a pace.
  std::uint64_t due_ = 0;    // the tick from which on the next frame is due
  bool left_ = false;        // the newest one is not written yet
  std::future<void> ended_;  // the slow thread
  std::jthread slow_;        // declared last: ends before what it uses
};

}  // namespace hapgrid
