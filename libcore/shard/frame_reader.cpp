#include "libcore/shard/frame_reader.hpp"

#include <algorithm>
#include <cstring>

#include "libcore/base/error.hpp"
#include "libcore/base/frame.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kMinimumRead = 64 << 10;

}  // namespace

void FrameReader::fail(const std::string& what) const {
  throw FormatError(file_->name() + ": byte " + std::to_string(offset_) + ": " + what);
}

std::span<const std::byte> FrameReader::next(std::uint64_t limit) {
  const std::uint64_t bound = frame_bound(limit);
  const std::uint64_t left = end_ - offset_;
  if (offset_ < buffer_offset_ || offset_ > buffer_offset_ + buffered_) buffered_ = 0;
  if (buffered_ == 0) buffer_offset_ = offset_;
  for (std::uint64_t want = kMinimumRead;; want *= 2) {
    const auto start = static_cast<std::size_t>(offset_ - buffer_offset_);
    const std::span<const std::byte> bytes(buffer_.data() + start, buffered_ - start);
    static constexpr unsigned char kMagic[] = {0x28, 0xB5, 0x2F, 0xFD};
    if (!bytes.empty() &&
        std::memcmp(bytes.data(), kMagic, std::min(sizeof kMagic, bytes.size())) != 0)
      fail("not a shard: no zstd frame");
    if (const std::size_t size = frame_size(bytes); size > 0) {
      offset_ += size;
      return bytes.first(size);
    }
    if (bytes.size() >= left) fail("truncated or damaged: a frame is cut");
    if (bytes.size() >= bound) fail("damaged: a frame is larger than any message can be");
    if (!read_up_to(static_cast<std::size_t>(std::min({left, want, bound}))))
      fail("truncated or damaged: a frame is cut");
  }
}

/// Moves the next frame's beginning to the front of the buffer and fills it up to `size` bytes, if
/// it has fewer; false at the end of the file.
bool FrameReader::read_up_to(std::size_t size) {
  const auto start = static_cast<std::size_t>(offset_ - buffer_offset_);
  if (buffered_ - start >= size) return true;
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(start),
            buffer_.begin() + static_cast<std::ptrdiff_t>(buffered_), buffer_.begin());
  buffered_ -= start;
  buffer_offset_ = offset_;
  buffer_.resize(std::max(buffer_.size(), size));
  const std::size_t count =
      file_->read(offset_ + buffered_, std::span(buffer_).subspan(buffered_, size - buffered_));
  buffered_ += count;
  return count > 0;
}

}  // namespace hapgrid
