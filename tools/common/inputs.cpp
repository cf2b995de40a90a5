#include "tools/common/inputs.hpp"

#include <filesystem>
#include <system_error>

#include "libcore/base/format.hpp"
#include "tools/common/command_line.hpp"

namespace hapgrid {

void keep_inputs(const std::vector<Output>& outputs, const std::vector<Input>& inputs) {
  std::error_code ignored;
  for (const auto& [option, output] : outputs) {
    // What is written to a pipe or a device replaces nothing, either.
    if (output == "-" || std::filesystem::is_other(output, ignored)) continue;
    for (const auto& [input, what] : inputs)
      if (same_file(output, input == "-" ? "/proc/self/fd/0" : input))
        throw UsageError(format("{}: would replace the {}", option, what));
  }
}

}  // namespace hapgrid
