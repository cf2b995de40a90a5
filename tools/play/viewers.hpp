// Who watches a play: a file or pipe of frames.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "libcore/loop/loop.hpp"
#include "libcore/model/fields.hpp"
#include "tools/play/publisher.hpp"

namespace hapgrid {

class Viewers {
 public:
  /// Starts the slow thread if there are frames to write.
  /// @param frames the file, "-" for standard output; empty: nobody watches. @param keys see Scene
  /// @param create as Fields has it. @param stop see FramePublisher.
  /// @param largest_force newtons that are sent at most in this grid
  Viewers(std::string frames, const std::string& keys, const GridSpec& spec,
          const MakeModel& create, double rate_hz, bool paced, const std::atomic<int>& stop,
          double largest_force);
  ~Viewers();

  /// Real-time safe when paced. @throw std::system_error when not.
  void show(const Tick& tick);
  /// Ends the slow thread. @throw what it threw
  void finish();

  /// Frames in the file, null without one. After finish().
  const FrameCounts* frames() const { return counts_ ? &*counts_ : nullptr; }
  /// On standard error, after finish().
  void print_summary() const;

 private:
  std::string name_;
  double rate_hz_;
  struct Slow;
  std::unique_ptr<Slow> slow_;
  std::optional<FrameCounts> counts_;
};

}  // namespace hapgrid
