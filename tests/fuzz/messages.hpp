// Cap'n Proto messages that stand one after the other, as `zstd -dc` gives them out of a shard or a
// session, and as the targets *_messages take them: those pack them into frames with digests that
// fit, since a fuzzer does not find a checksum.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace hapgrid::fuzz {

using Words = std::vector<std::uint64_t>;

/// How many words the message in front has by its own table of segments; all where that cannot be.
inline std::size_t message_words(std::span<const std::uint64_t> words) {
  const std::uint64_t segments = (words[0] & 0xffffffff) + 1;
  const std::uint64_t table = segments / 2 + 1;
  if (table > words.size()) return words.size();
  std::uint64_t size = table;
  for (std::uint64_t i = 1; i <= segments; ++i) size += words[i / 2] >> (i % 2 * 32) & 0xffffffff;
  return std::min<std::uint64_t>(size, words.size());
}

/// The messages of an input; what is left of a last word is dropped.
inline std::vector<Words> split(std::span<const std::uint8_t> bytes) {
  Words all(bytes.size() / sizeof(std::uint64_t));
  if (!all.empty()) std::memcpy(all.data(), bytes.data(), all.size() * sizeof(std::uint64_t));
  std::vector<Words> messages;
  for (std::span<const std::uint64_t> rest(all); !rest.empty();) {
    const std::size_t size = message_words(rest);
    messages.emplace_back(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(size));
    rest = rest.subspan(size);
  }
  return messages;
}

inline std::span<const std::byte> bytes_of(const Words& words) {
  return std::as_bytes(std::span(words));
}

inline void append(std::vector<std::byte>& to, std::span<const std::byte> bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

}  // namespace hapgrid::fuzz
