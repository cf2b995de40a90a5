// Starts model processes, and ends them and whatever they started, however this program ends.
//
// The keeper is a second process, which starts the models for this one. It is their parent and a
// subreaper (libcore/base/family.hpp): what a model starts cannot leave it, and when this program
// is gone it kills all of that. A model dies with the keeper. Where somebody kills the keeper,
// too, there is a second net: each model process has a mark in its environment, which what it
// starts inherits, and what has the mark is looked for in /proc.
//
// It also keeps this program from copying its memory for each model: the keeper is forked while
// there is little.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/model/keeper_process.hpp"

namespace hapgrid {

/// What the keeper is to start.
struct Launch {
  std::string file;
  std::vector<std::string> words;  ///< arguments, the program's name first
  std::string directory;           ///< empty: that of this program
  int in = -1;                     ///< standard input, output and error
  int out = -1;
  int errors = -1;
};

/// A process that the keeper has started.
struct Kept {
  pid_t pid = -1;    ///< nobody else's until it is ended; it leads a group of that number
  std::string mark;  ///< in the environment of all that it starts
};

/// How such a process ended.
struct KeptEnd {
  std::string how;            ///< "exited with status 3"
  bool has_given_up = false;  ///< it ended by itself, and not with status 0
};

/// The keeper process. Make it before there are threads or large data, which it would copy.
class Keeper {
 public:
  /// @throw std::system_error
  Keeper();
  /// Returns when the keeper has killed all that it started, and all that this started.
  ~Keeper();
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  // From any thread.

  /// @throw Error "cannot be started: ..."
  Kept start(const Launch& launch);
  bool has_ended(const Kept& child) const;
  /// Kills its group and waits for it.
  KeptEnd end(const Kept& child);
  /// Kills what has its mark, and what these processes start meanwhile.
  static void kill_marked(const Kept& child);

 private:
  /// Nothing when the keeper is gone.
  std::optional<KeeperAnswer> ask(const KeeperRequest& request,
                                  std::span<const int> files = {}) const;

  std::string mark_;
  FileDescriptor socket_;  // which the kernel closes with this program
  pid_t pid_ = -1;
  mutable std::mutex mutex_;
  std::atomic<unsigned> children_{0};
};

}  // namespace hapgrid
