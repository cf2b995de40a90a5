// Starts child processes, each in a process group of its own.
//
// The kernel kills a child when this program ends, however it ends (PR_SET_PDEATHSIG). To the
// kernel the parent of a child is the thread that started it, not the program. So a launcher has a
// thread that starts all its children and lives longer than they do.
#pragma once

#include <sys/types.h>

#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "libcore/base/file.hpp"

namespace hapgrid {

/// A child process, and this program's ends of the pipes that are its standard streams.
struct Child {
  pid_t pid = -1;  ///< also the number of its process group
  FileDescriptor input, output, errors;
};

class Launcher {
 public:
  Launcher();
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  /// May be called by any thread. The child has only its standard streams open.
  /// @param file the program's path
  /// @param words the arguments, which begin with the program's name
  /// @param directory where the child runs; empty: where this program runs
  /// @throw Error "cannot be started in DIRECTORY: ..."; std::system_error
  Child start(const std::string& file, const std::vector<std::string>& words,
              const std::string& directory);

 private:
  void run(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any has_task_;
  std::deque<std::packaged_task<Child()>> tasks_;
  std::jthread thread_;  // declared last: it uses the others
};

}  // namespace hapgrid
