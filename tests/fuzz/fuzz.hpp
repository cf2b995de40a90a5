// What the fuzz targets share. A target hands the bytes of one input to its readers; a refusal that
// a reader's header announces is no finding, anything else is.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace hapgrid::fuzz {

/// Runs `read`, which may refuse its input.
template <class F>
void refusable(F&& read) {
  try {
    read();
  } catch (const Error&) {
  } catch (const std::system_error&) {
  }
}

inline std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A file in memory.
class MemoryFile {
 public:
  explicit MemoryFile(std::span<const std::byte> bytes)
      : file_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    while (!bytes.empty()) {
      const ssize_t count = ::write(file_.get(), bytes.data(), bytes.size());
      if (count < 0) throw std::runtime_error("no file in memory");  // a finding, of this machine
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
    ::lseek(file_.get(), 0, SEEK_SET);
  }

  /// For what opens a name.
  std::string name() const { return "/proc/self/fd/" + std::to_string(file_.get()); }
  /// For what takes an open file, which it closes; from the start.
  FileDescriptor take() { return std::move(file_); }

 private:
  FileDescriptor file_;
};

}  // namespace hapgrid::fuzz
