// Zstd frames: one holds one Cap'n Proto message, its size and its checksum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace hapgrid {

class InputFile;

/// A message of Cap'n Proto with its segment table, aligned as it wants it.
using MessageWords = std::vector<std::uint64_t>;

/// Whether a file begins with what every zstd frame begins with.
bool starts_with_zstd_frame(const InputFile& file);
/// What a file was compressed by that holds zstd frames, or something else: "gzip". Empty where it
/// begins with none of the common kinds, and where it begins with zstd frames that hold none.
const char* outer_compression(const InputFile& file);
/// Bytes of the zstd frame that `bytes` starts with; 0 when none is there as a whole.
std::size_t zstd_frame_size(std::span<const std::byte> bytes);
/// The most bytes that a zstd frame with `content` bytes can have.
std::size_t zstd_frame_bound(std::uint64_t content);

/// Compresses messages. The bytes depend on the content, on what the constructor is told, and on
/// zstd.
class ZstdFrameEncoder {
 public:
  /// @param level zstd's: 3 is its own default. Below 0 it leaves bytes that occur nowhere before
  /// as they are, which is faster, both ways, and larger where numbers are smooth.
  explicit ZstdFrameEncoder(int level = 1) : level_(level) {}

  /// The zstd frame is valid until the next call.
  std::span<const std::byte> encode(std::span<const std::byte> content);

 private:
  int level_;
  std::unique_ptr<std::byte[]> frame_;
  std::size_t capacity_ = 0;
};

/// Decodes a zstd frame without anything behind it into `words` (8-byte aligned, as Cap'n Proto
/// wants them).
/// @param limit bytes of content that are possible here; a larger claim is refused before any
/// memory is taken for it.
/// @param kind what the zstd frame is of, for messages: "not a `kind`: ..."
/// @throw FormatError (without the file's name) when the zstd frame is damaged or too large.
void decode_zstd_frame(std::span<const std::byte> frame, std::uint64_t limit, const char* kind,
                       MessageWords& words);

}  // namespace hapgrid
