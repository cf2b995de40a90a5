// Goes through a stream of zstd frames without decoding them, from size to size, so that what is
// no such stream is known before it is stored.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace hapgrid {

class ZstdWalk {
 public:
  static constexpr std::byte kFirstByte{0x28};  ///< of a zstd frame that is not to be skipped

  /// Takes the next bytes of the stream. False when they begin or contain what belongs to no zstd
  /// frame; then nothing more may be taken. What is in the frames can still be damaged.
  bool take(std::span<const std::byte> bytes);

 private:
  bool end_of_frame_header();
  bool end_of_block_header();

  std::uint64_t skip_ = 0;          // bytes until the next header
  std::array<std::byte, 18> head_;  // a header's bytes so far; a frame's has 18 at most
  std::size_t size_ = 0;            // of these
  bool in_frame_ = false;           // the next header is a block's
  bool has_checksum_ = false;       // the frame ends with four more bytes
};

}  // namespace hapgrid
