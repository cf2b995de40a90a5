// Ends whatever model processes started, however this program ends.
//
// A model process dies with this program (ChildProcess), but what it started does not: the kernel
// kills one process with its parent, not a family. A process group is left by setsid(); a control
// group or a namespace needs rights that users do not have everywhere; as a subreaper this program
// would get the orphans of a model, and nobody would when this program is killed. So each model
// process gets a mark in its environment, which all that it starts inherit, and a second process,
// the keeper, looks for the mark in /proc once this program is gone.
//
// What changes its environment (env -i) or its user escapes.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "libcore/base/file.hpp"

namespace hapgrid {

/// Kills the processes that have `mark` in their environment, and those that they start meanwhile.
void kill_marked(const std::string& mark);

/// The keeper process. Make it before there are threads or large data, which it would copy.
class Keeper {
 public:
  /// @throw std::system_error
  Keeper();
  /// Returns when the keeper has killed all that has the mark.
  ~Keeper();
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  /// A mark of one model process; it contains that of the keeper.
  std::string mark(unsigned number) const { return mark_ + std::to_string(number) + "/"; }
  /// This program's environment with a mark, "NAME=VALUE" each. A model process that uses hapgrid
  /// itself hands its own mark on with those of its models.
  static std::vector<std::string> environment(const std::string& mark);

 private:
  std::string mark_;
  FileDescriptor alive_;  // a pipe's end, which the kernel closes with this program
  pid_t pid_ = -1;
};

}  // namespace hapgrid
