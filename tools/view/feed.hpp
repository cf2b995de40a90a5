// Reads frames in a thread of its own, which never waits for the drawing. While few frames wait,
// the drawing gets each of them, so that a hiccup of the machine costs no picture; else it gets the
// newest one.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "libcore/base/file.hpp"
#include "libcore/scene/stream.hpp"

namespace hapgrid {

/// A stream is read as fast as it comes, so that its writer never waits. The frames of a regular
/// file are given out in the time in which they were recorded.
class Feed {
 public:
  /// Waits for the scene and reads it; "-" is standard input. `changed` is called on the reading
  /// thread when there is a new frame, or the end.
  /// @throw std::system_error, FormatError as SceneReader does.
  Feed(const std::string& name, std::function<void()> changed);
  ~Feed();
  Feed(const Feed&) = delete;
  Feed& operator=(const Feed&) = delete;

  const Scene& scene() const { return reader_.scene(); }
  /// The name for messages.
  const std::string& name() const { return reader_.name(); }

  /// Starts reading.
  void start();
  /// Whether the frames are those of a regular file.
  bool recorded() const { return recorded_; }
  /// The state of the stream. `frame` is written only when there is a new one.
  struct State {
    bool fresh = false;
    bool more = false;   ///< whether a newer frame waits already
    bool ended = false;  ///< whether this frame is the last one
  };
  State update(Frame& frame);
  /// Called when the stream has ended. @throw the error that ended it, if there was one.
  void check() const;

 private:
  using Clock = std::chrono::steady_clock;

  /// At 60 frames a second this is 0.05 s, which no hand feels as a delay.
  static constexpr std::size_t kMostWaiting = 3;

  void run();
  bool wait_until_due(double time_s);

  SceneReader reader_;
  std::function<void()> changed_;
  bool recorded_;
  FileDescriptor stop_reading_;  // readable: the reading thread is to end

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  bool stopped_ = false;
  double first_s_ = 0;         // the time of the recording's first frame
  Clock::time_point start_;    // when that frame was due
  std::deque<Frame> waiting_;  // the oldest first
  bool late_ = false;          // too many waited: only the newest one is kept
  bool ended_ = false;
  std::exception_ptr error_;

  std::jthread thread_;
};

}  // namespace hapgrid
