// The failures that hapgrid's library reports. A failure of the operating system is a
// std::system_error; a bug is an assert; an outcome that a caller expects is a return value.
#pragma once

#include <stdexcept>
#include <string>

namespace hapgrid {

/// Something that the user must hear about in one line: what, where, the value and its limit.
/// The tool's name is put in front of it by run_tool() (tools/common).
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A stream that is no shard, is damaged or truncated, or describes another grid.
class FormatError : public Error {
 public:
  using Error::Error;
};

/// A model that could not be found or created, or that answered with something unusable.
class ModelError : public Error {
 public:
  using Error::Error;
};

/// A device that could not be opened or that failed while it was used.
class DeviceError : public Error {
 public:
  using Error::Error;
};

}  // namespace hapgrid
