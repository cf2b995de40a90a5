// A round, or all rounds, by processes that have one model each. For a plug-in whose models share
// data, so that two threads must not ask two of them at once: a process has data of its own.
#pragma once

#include <string>
#include <vector>

namespace hapgrid {

struct ProcessRounds {
  std::string grid;  ///< "-": standard input
  std::string output;
  bool complete = false;  ///< all rounds, until nothing is left to do; else one
  unsigned processes = 1;
  std::vector<std::string> of_both;    ///< options of expand and merge: plug-ins, costs
  std::vector<std::string> of_expand;  ///< options of expand alone
};

/// Runs this program for each part of a round, and merge between rounds, in a temporary folder.
/// What the processes say to standard error is said when their round is over; of a round that
/// fails, what the first part that failed has said. Libraries for linear algebra get one thread
/// each.
/// @returns the exit code: 0, that of the process that failed, or 128 + the signal that came
/// @throw std::system_error, FormatError, Error
int expand_in_processes(const ProcessRounds& rounds);

}  // namespace hapgrid
