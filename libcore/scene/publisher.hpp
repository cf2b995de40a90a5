// From the haptic loop to a viewer.
//
// Problem. The loop must never wait for a viewer, nor for the shape of a state, which a model may
// need milliseconds for. Paced, the loop leaves each tick in a triple buffer, and a slow thread
// takes the newest one 25 times a second, completes it once for all who see it, and writes it; what
// a viewer is too slow for is dropped and counted. A play without a pace has no deadlines: each
// tick of scripted time that is due is written where it happens, so that the same play gives the
// same bytes.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <thread>

#include "libcore/scene/output.hpp"
#include "libcore/scene/scene.hpp"
#include "libcore/scene/stream.hpp"
#include "libcore/base/triple_buffer.hpp"

namespace hapgrid {

/// How writing frames to the file went.
struct FrameCounts {
  std::uint64_t written = 0;
  std::uint64_t dropped = 0;  ///< due while the viewer, or the slow thread, was behind
  bool closed = false;        ///< the viewer closed its end: there are no frames behind that
  bool cut = false;           ///< the viewer did not read any more: the last message is cut
};

class FramePublisher {
 public:
  /// Sets energy and centres (which has the scene's size) of a frame from what the haptic loop
  /// left.
  using Complete = std::function<void(Frame&)>;
  /// Gets each completed frame before the file does; where the file's viewer is slow also those
  /// that the file misses. May throw.
  using Show = std::function<void(const Frame&)>;

  /// @param output the file or pipe for frames, if any.
  /// @param row_size numbers in each snapshot's row; the scene's state_size or more.
  /// @param complete called from the slow thread when paced.
  /// @param ticks_per_second how much scripted time a tick is, for a play without a pace.
  /// @param stop nonzero, through a signal's handler: a play without a pace no longer waits for its
  /// viewer.
  /// @param show called where `complete` is; should not take long.
  /// @throw std::system_error
  FramePublisher(std::optional<OutputFile> output, const Scene& scene, std::size_t row_size,
                 Complete complete, bool paced, double ticks_per_second,
                 const std::atomic<int>& stop, Show show = {});
  /// Without finish(): no file appears.
  ~FramePublisher();
  FramePublisher(const FramePublisher&) = delete;
  FramePublisher& operator=(const FramePublisher&) = delete;

  /// The snapshot to fill for the tick at hand, all of it; its vectors have their sizes.
  /// Real-time safe.
  Snapshot& next() noexcept { return buffer_.back(); }
  /// The snapshot is filled. Paced: real-time safe. @throw std::system_error when not paced.
  void publish();

  /// After the last tick, which becomes the last frame. Waits at most a second for a slow viewer.
  /// @throw std::system_error, also what the slow thread has met
  FrameCounts finish();

 private:
  using GiveUp = std::function<bool()>;

  void run(const std::stop_token& token);
  /// False when nothing more can be written.
  bool write(std::span<const std::byte> message, const GiveUp& give_up);
  void write_scene(const GiveUp& give_up);
  void write_newest(const GiveUp& give_up);
  void complete_newest();
  /// The file takes more.
  bool open() const { return output_ && !counts_.closed && !counts_.cut; }

  std::optional<FrameOutput> output_;
  const Scene scene_;
  const Complete complete_;
  const Show show_;
  const bool paced_;
  const std::uint64_t ticks_per_frame_;  // without a pace
  const GiveUp stopped_;
  TripleBuffer<Snapshot> buffer_;
  // From here on the slow thread's while it runs.
  SceneEncoder encoder_;
  Frame frame_;
  bool unwritten_ = false;  // the frame is newer than what the file has
  FrameCounts counts_;
  std::exception_ptr failure_;
  // Without a pace.
  std::uint64_t due_ = 0;  // the tick from which on the next frame is due
  bool left_ = false;      // the snapshot is no frame yet
  std::jthread slow_;      // declared last: ends before what it uses
};

}  // namespace hapgrid
