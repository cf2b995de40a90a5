// An output must not replace what the same program reads.
#pragma once

#include <string>
#include <vector>

namespace hapgrid {

/// A file that is read: its name, "-" for standard input, or empty for none; and what it is.
struct Input {
  std::string file;
  const char* what;
};

/// A file that is written: the option that names it, and its name, "-" for standard output, which
/// replaces nothing, or empty for none.
struct Output {
  const char* option;
  std::string file;
};

/// @throw UsageError when an output is one of the inputs, also by another name
void keep_inputs(const std::vector<Output>& outputs, const std::vector<Input>& inputs);

}  // namespace hapgrid
