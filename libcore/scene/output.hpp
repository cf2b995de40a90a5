// Where frames go: a file, or a viewer behind a pipe that may be slow, asleep or dead.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "libcore/base/file.hpp"

namespace hapgrid {

/// A closed pipe is an outcome here and no SIGPIPE, whatever the process does with that signal.
class FrameOutput {
 public:
  enum class Status {
    kWritten,
    kClosed,   ///< nobody reads any more
    kGivenUp,  ///< a message is cut: nothing may be written behind it
  };

  explicit FrameOutput(OutputFile file);

  /// Writes all of `message`. While the viewer does not take more, `give_up` is asked several times
  /// a second whether to leave the message cut.
  /// @throw std::system_error
  Status write(std::span<const std::byte> message, const std::function<bool()>& give_up);

  /// Makes a file appear. @throw std::system_error
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
  std::size_t piece_;  // bytes that can be written at once without waiting, once poll() has said so
};

}  // namespace hapgrid
