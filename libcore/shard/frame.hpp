// zstd frames, whole: one frame holds one message, carries its content size and checksum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"

namespace hapgrid {

/// Compresses messages, reusing its context. The bytes depend on the content and on zstd alone.
class FrameEncoder {
 public:
  /// `level`: zstd's, the default is for what is written and read once.
  explicit FrameEncoder(int level = 1);
  ~FrameEncoder();
  FrameEncoder(FrameEncoder&&) noexcept;

  /// The frame is valid until the next call.
  std::span<const std::byte> encode(std::span<const std::byte> content);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
  std::unique_ptr<std::byte[]> frame_;
  std::size_t capacity_ = 0;
};

/// Decompresses frames, reusing its context.
class FrameDecoder {
 public:
  /// @param hashed the frames are compared with a hash of them before they are decoded, so that
  /// zstd need not compute the content's checksum, too.
  explicit FrameDecoder(bool hashed = false);
  ~FrameDecoder();
  FrameDecoder(FrameDecoder&&) noexcept;

  /// Decodes a whole frame into `words` (8-byte aligned, as Cap'n Proto wants them).
  /// @param limit bytes of content that are possible here; a larger claim is refused before any
  /// memory is taken for it.
  /// @throw FormatError (without the file's name) when the frame is damaged or too large.
  void decode(std::span<const std::byte> frame, std::uint64_t limit,
              std::vector<std::uint64_t>& words);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

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
