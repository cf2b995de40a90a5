#include "libcore/base/zstd_frame.hpp"

#include <zstd.h>

#include <array>
#include <memory>
#include <new>
#include <string_view>
#include <type_traits>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

namespace {

/// A thread has one context of each kind for all zstd frames: making one asks the processor what it
/// can do, which takes longer than a small zstd frame, above all in a virtual machine.
template <auto kCreate, auto kFree>
auto* context_of_thread() {
  using Zstd = std::remove_pointer_t<decltype(kCreate())>;
  thread_local const std::unique_ptr<Zstd, decltype(kFree)> context(kCreate(), kFree);
  if (!context) throw std::bad_alloc();
  return context.get();
}

/// Whether the content of the zstd frame that a file begins with begins with a zstd frame.
bool is_zstd_in_zstd(std::span<const std::byte> start) {
  ZSTD_DCtx* const zstd = context_of_thread<ZSTD_createDCtx, ZSTD_freeDCtx>();
  ZSTD_DCtx_reset(zstd, ZSTD_reset_session_only);
  std::array<std::byte, kZstdMagic.size()> content{};
  ZSTD_inBuffer in{start.data(), start.size(), 0};
  ZSTD_outBuffer out{content.data(), content.size(), 0};
  while (out.pos < out.size && in.pos < in.size) {
    const std::size_t before = in.pos + out.pos;
    if (ZSTD_isError(ZSTD_decompressStream(zstd, &out, &in)) || in.pos + out.pos == before) break;
  }
  ZSTD_DCtx_reset(zstd, ZSTD_reset_session_only);
  return out.pos == out.size && content == kZstdMagic;
}

}  // namespace

const char* outer_compression(const InputFile& file) {
  std::vector<std::byte> start(std::size_t{1} << 18);  // a block of zstd, and its header
  start.resize(file.read(0, start));
  const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
  if (text.starts_with("\x1f\x8b")) return "gzip";
  if (text.starts_with("BZh")) return "bzip2";
  if (text.starts_with("\xfd\x37zX")) return "xz";
  if (text.starts_with("PK\3\4")) return "zip";
  if (text.starts_with("\x04\x22\x4d\x18")) return "lz4";
  return is_zstd_in_zstd(start) ? "zstd" : "";
}

bool starts_with_zstd_frame(const InputFile& file) {
  std::array<std::byte, kZstdMagic.size()> start{};
  return file.read(0, start) == start.size() && start == kZstdMagic;
}

std::size_t zstd_frame_size(std::span<const std::byte> bytes) {
  const std::size_t size = ZSTD_findFrameCompressedSize(bytes.data(), bytes.size());
  return ZSTD_isError(size) ? 0 : size;
}

std::size_t zstd_frame_bound(std::uint64_t content) { return ZSTD_compressBound(content) + 64; }

std::span<const std::byte> ZstdFrameEncoder::encode(std::span<const std::byte> content) {
  if (const std::size_t bound = zstd_frame_bound(content.size()); bound > capacity_) {
    frame_ = std::make_unique_for_overwrite<std::byte[]>(bound);
    capacity_ = bound;
  }
  ZSTD_CCtx* const zstd = context_of_thread<ZSTD_createCCtx, ZSTD_freeCCtx>();
  ZSTD_CCtx_setParameter(zstd, ZSTD_c_compressionLevel, level_);
  ZSTD_CCtx_setParameter(zstd, ZSTD_c_checksumFlag, 1);
  ZSTD_CCtx_setParameter(zstd, ZSTD_c_contentSizeFlag, 1);
  const std::size_t size =
      ZSTD_compress2(zstd, frame_.get(), capacity_, content.data(), content.size());
  if (ZSTD_isError(size)) throw Error(format("zstd: {}", ZSTD_getErrorName(size)));
  return {frame_.get(), size};
}

void decode_zstd_frame(std::span<const std::byte> frame, std::uint64_t limit, const char* kind,
                       MessageWords& words) {
  if (frame.empty() || zstd_frame_size(frame) != frame.size())
    throw FormatError("damaged: a zstd frame is cut");
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR)
    throw FormatError(format("not a {}: a zstd frame without its content's size", kind));
  if (size > limit)
    throw FormatError(format("a message of {} bytes, the limit is {}", size, limit));
  if (size == 0 || size % sizeof(std::uint64_t) != 0)
    throw FormatError(format("not a {}: no Cap'n Proto message", kind));
  words.resize(size / sizeof(std::uint64_t));
  ZSTD_DCtx* const zstd = context_of_thread<ZSTD_createDCtx, ZSTD_freeDCtx>();
  const std::size_t decoded =
      ZSTD_decompressDCtx(zstd, words.data(), size, frame.data(), frame.size());
  if (ZSTD_isError(decoded)) throw FormatError(format("damaged: {}", ZSTD_getErrorName(decoded)));
  if (decoded != size) throw FormatError("damaged: a zstd frame is shorter than it says");
}

}  // namespace hapgrid
