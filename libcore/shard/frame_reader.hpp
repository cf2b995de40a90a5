// The zstd frames of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"

namespace hapgrid {

/// Finds the frames of a file one after another, from `offset` to `end`, without decoding them.
class FrameReader {
 public:
  FrameReader(const InputFile& file, std::uint64_t offset, std::uint64_t end)
      : file_(&file), offset_(offset), end_(end) {}

  /// Where the next frame starts.
  std::uint64_t offset() const { return offset_; }
  bool at_end() const { return offset_ == end_; }
  void seek(std::uint64_t offset) { offset_ = offset; }

  /// The next frame as it is stored, valid until the next call.
  /// @param limit bytes that its content can have.
  /// @throw FormatError with file and offset when it is cut, or no frame.
  std::span<const std::byte> next(std::uint64_t limit);

 private:
  [[noreturn]] void fail(const std::string& what) const;
  bool read_up_to(std::size_t size);

  const InputFile* file_;
  std::uint64_t offset_;
  std::uint64_t end_;
  std::vector<std::byte> buffer_;  // file bytes from buffer_offset_
  std::uint64_t buffer_offset_ = 0;
  std::size_t buffered_ = 0;
};

}  // namespace hapgrid
