#include <unistd.h>

#include <string>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "tools/common/inputs.hpp"
#include "tools/common/tool.hpp"
#include "tools/play/beside.hpp"
#include "tools/play/log.hpp"
#include "tools/play/options.hpp"

namespace hapgrid {

namespace {

/// @throw UsageError when an output would replace an input.
void check_files(const PlayOptions& options) {
  const std::string input = input_file(*options.device);
  if (options.grid == "-" && input == "-")
    throw UsageError("the grid and the device cannot both be standard input");
  keep_inputs({{"--log", options.log}, {"--frames", options.frames}, {"--report", options.report}},
              {{input, "file that --device names"},
               {options.grid, "grid"},
               {options.model.allowed, "definition"}});
}

}  // namespace

void require_possible(const PlayOptions& options) {
  const bool adapter = options.device && has_adapter(*options.device);
  // Without a grid, a device is brought up.
  if (options.grid.empty() && !adapter) throw UsageError("grid is required");
  if (!options.device) throw UsageError("--device is required");
  check_files(options);
  if (adapter && options.rate_hz > 0 && options.rate_hz < kSlowestProcessHz)
    throw UsageError(
        format("--rate: an adapter lets go of the hand below {} Hz", rounded(kSlowestProcessHz)));
  if (options.beside && *options.beside != kBesideOff) {
    if (options.traversal.value_or(kDefaultRule) != TraversalRule::kBranch)
      throw UsageError("--beside: only --traversal branch has branches between which to choose");
    if (*options.beside != kBesideOn && is_live(*options.device))
      throw UsageError("--beside: how late the model is for a live device cannot be chosen");
  }
  if (!options.model.allowed.empty() &&
      (options.traversal == TraversalRule::kPaper ||
       (options.beside == kBesideOff && options.traversal != TraversalRule::kModel)))
    throw UsageError("--allow-process: with --beside off or --traversal paper, no model is asked");
  if (options.realtime && !is_live(*options.device) && options.rate_hz == 0)
    throw UsageError(
        "--realtime: only a live device, or a path or replay with --rate, is played in real time");
  if (!options.log.empty() && !is_session_name(options.log) && is_live(*options.device))
    throw UsageError(
        "--log: a text log cannot be used with a live device; give a name that ends in "
        ".session");
  if (options.frames == "-" && ::isatty(STDOUT_FILENO))
    throw Error("standard output is a terminal: redirect it, or name a file after --frames");
}

}  // namespace hapgrid
