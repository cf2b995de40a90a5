// Shards and sessions taken apart and put together again: both are Cap'n Proto messages in zstd
// frames. The last message of a shard's section is a footer that a locator follows; a session has
// none. A fuzzer does not find a checksum, so the mutator (mutate.hpp) changes the messages, and
// what depends on them is made anew.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "libcore/base/digest.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/shard/format.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace hapgrid::fuzz {

using Words = std::vector<std::uint64_t>;

/// Messages up to a locator, which says that the last one is a footer.
struct Messages {
  std::vector<Words> all;
  bool has_footer = false;
};

/// A file: sections, and what stands behind them that is no zstd frame.
struct Parts {
  std::vector<Messages> sections;
  std::vector<std::byte> tail;
};

/// What a footer says of a message before it.
struct Framed {
  std::uint64_t offset = 0, size = 0;  ///< of its zstd frame in the file
  Digest digest;                       ///< of the message
};

/// Puts what is true of the messages before it into a footer; may refuse a footer that is none.
using FitFooter = void (*)(Words& footer, std::span<const Framed> before);

inline std::span<const std::byte> bytes_of(const Words& words) {
  return std::as_bytes(std::span(words));
}

inline std::optional<Words> decode(std::span<const std::byte> frame) {
  constexpr std::uint64_t kLimit = 1 << 20;
  std::optional<Words> words;
  refusable([&] {
    Words decoded;
    decode_zstd_frame(frame, kLimit, "input", decoded);
    words = std::move(decoded);
  });
  return words;
}

inline Parts take_apart(std::span<const std::byte> file) {
  Parts parts;
  bool goes_on = false;  // the last section has no footer yet
  while (!file.empty()) {
    Locator locator{.magic = 0};
    if (file.size() >= sizeof locator) std::memcpy(&locator, file.data(), sizeof locator);
    if (goes_on && locator.is_valid()) {
      parts.sections.back().has_footer = true;
      goes_on = false;
      file = file.subspan(sizeof locator);
      continue;
    }
    const std::size_t size = zstd_frame_size(file);
    std::optional<Words> words = size == 0 ? std::nullopt : decode(file.first(size));
    if (!words) break;
    if (!goes_on) parts.sections.emplace_back();
    goes_on = true;
    parts.sections.back().all.push_back(std::move(*words));
    file = file.subspan(size);
  }
  parts.tail.assign(file.begin(), file.end());
  return parts;
}

inline std::vector<std::byte> put_together(Parts parts, FitFooter fit) {
  static ZstdFrameEncoder encoder;
  std::vector<std::byte> file;
  for (Messages& section : parts.sections) {
    std::vector<Framed> before;
    for (Words& message : section.all) {
      const bool is_footer = section.has_footer && &message == &section.all.back();
      if (is_footer) refusable([&] { fit(message, before); });
      const std::span<const std::byte> frame = encoder.encode(bytes_of(message));
      before.push_back({file.size(), frame.size(), digest_of(bytes_of(message))});
      file.insert(file.end(), frame.begin(), frame.end());
      if (!is_footer) continue;
      const Locator locator{.footer = frame.size()};
      const auto end = std::as_bytes(std::span(&locator, 1));
      file.insert(file.end(), end.begin(), end.end());
    }
  }
  file.insert(file.end(), parts.tail.begin(), parts.tail.end());
  return file;
}

}  // namespace hapgrid::fuzz
