#include "tools/play/refusals.hpp"

#include <unistd.h>

#include <filesystem>
#include <string>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "tools/common/tool.hpp"
#include "tools/play/beside.hpp"
#include "tools/play/log.hpp"

namespace hapgrid {

namespace {

/// Whether two names are the same file.
bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;  // when one of them does not exist they are not the same
  return !a.empty() && (a == b || std::filesystem::equivalent(a, b, ignored));
}

/// @throw UsageError when an output would replace an input, or two outputs are one file.
void check_files(const PlayOptions& options) {
  const std::string input = input_file(*options.device);
  if (options.grid == "-" && input == "-")
    throw UsageError("the grid and the device cannot both be standard input");
  struct Output {
    const char* option;
    const char* what;
    const std::string& file;
  };
  const Output outputs[] = {{"--log", "the log", options.log},
                            {"--frames", "the frames", options.frames},
                            {"--report", "the report", options.report},
                            {"--sessions", "the table", options.sessions}};
  for (const Output& output : outputs) {
    if (output.file == "-") continue;
    const char* replaced = same_file(output.file, input)          ? "file that --device names"
                           : same_file(output.file, options.grid) ? "grid"
                                                                  : nullptr;
    if (replaced)
      throw UsageError(format("{}: {} would replace the {}", output.option, output.what, replaced));
  }
  for (std::size_t i = 0; i < std::size(outputs); ++i)
    for (std::size_t j = i + 1; j < std::size(outputs); ++j)
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
