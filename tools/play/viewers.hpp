// What a play shows beside the force: frames in a file or pipe, and to viewers of molecules (IMD).
#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include "libcore/haptic/loop.hpp"
#include "libcore/model/fields.hpp"
#include "libcore/scene/imd_server.hpp"
#include "libcore/scene/publisher.hpp"
#include "tools/play/options.hpp"

namespace hapgrid {

class Viewers {
 public:
  /// Takes IMD's port, if one is wanted, and says so. @throw std::system_error
  explicit Viewers(const PlayOptions& options);

  /// Starts the slow thread, if anybody is to see anything.
  /// @param spec outlives this. @param create as Fields has it. @param stop see FramePublisher.
  void start(const GridSpec& spec, const MakeModel& create, double rate_hz, bool paced,
             const std::atomic<int>& stop);
  /// --imd-wait.
  void wait(const std::atomic<int>& stop);
  /// Real-time safe when paced. @throw std::system_error when not.
  void show(const Tick& tick);
  /// @throw what the slow thread has met
  void finish();

  /// Of the file, when there is one. After finish().
  const FrameCounts* frames() const { return file_ ? &*counts_ : nullptr; }
  /// On standard error. After finish().
  void print_summary() const;

 private:
  const PlayOptions& options_;
  bool file_;
  double rate_hz_ = kUnpacedHz;
  std::optional<ImdServer> imd_;
  std::optional<Fields> fields_;  // of the slow thread
  std::optional<FramePublisher> publisher_;
  std::optional<FrameCounts> counts_;
  std::optional<ImdCounts> imd_counts_;
};

}  // namespace hapgrid
