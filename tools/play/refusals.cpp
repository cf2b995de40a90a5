#include "tools/play/refusals.hpp"

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

namespace hapgrid {

namespace {

/// @throw UsageError when an output would replace an input, or two outputs are one file.
void check_files(const PlayOptions& options) {
  const std::string input = input_file(*options.device);
  if (options.grid == "-" && input == "-")
    throw UsageError("the grid and the device cannot both be standard input");
  const std::vector<Output> outputs = {{"--log", options.log},
                                       {"--frames", options.frames},
                                       {"--report", options.report},
                                       {"--sessions", options.sessions}};
  keep_inputs(outputs, {{input, "file that --device names"},
                        {options.grid, "grid"},
                        {options.model.allowed, "definition"}});
  for (std::size_t i = 0; i < outputs.size(); ++i)
    for (std::size_t j = i + 1; j < outputs.size(); ++j)
      if (same_file(outputs[i].file, outputs[j].file))
        throw UsageError(format("{} and {} cannot both be {}", outputs[i].option, outputs[j].option,
                                outputs[j].file));
}

}  // namespace

void require_possible(const PlayOptions& options) {
  const bool has_adapter = options.device && std::holds_alternative<AdapterChoice>(*options.device);
  // Without a grid, a device is only looked at.
  if (options.grid.empty() && !has_adapter) throw UsageError("grid is required");
  if (!options.device) throw UsageError("--device is required");
  check_files(options);
  if (has_adapter && options.rate_hz > 0 && options.rate_hz < kSlowestProcessHz)
    throw UsageError(
        format("--rate: an adapter lets go of the hand below {} Hz", rounded(kSlowestProcessHz)));
  if (options.beside && *options.beside != kBesideOff) {
    if (options.traversal.value_or(kDefaultRule) != TraversalRule::kBranch)
      throw UsageError("--beside: only --traversal branch has branches between which to choose");
    if (*options.beside != kBesideOn && is_live(*options.device))
      throw UsageError("--beside: how late the model is for a live device cannot be chosen");
  }
  if (options.traversal == TraversalRule::kModel && options.force &&
      options.force != ForceRule::kState)
    throw UsageError("--force: --traversal model has no records to interpolate between");
  if (!options.sessions.empty() && !std::holds_alternative<SimulationFile>(*options.device))
    throw UsageError("--sessions: only --device sim:FILE has sessions to tell of");
  if (!options.log.empty() && !is_session_name(options.log) && is_live(*options.device))
    throw UsageError(
        "--log: a text log cannot be used with a live device; give a name that ends in "
        ".session");
  if (options.frames == "-" && ::isatty(STDOUT_FILENO))
    throw Error("standard output is a terminal: redirect it, or name a file after --frames");
}

}  // namespace hapgrid
