// The digest of a section's decoded content: XXH3-128, seed 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace hapgrid {

struct Digest {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
  friend bool operator==(const Digest&, const Digest&) = default;
};

/// Of one message.
Digest digest_of(std::span<const std::byte> bytes);

/// XXH3-64, seed 0.
std::uint64_t hash_of(std::span<const std::byte> bytes);

/// Of a section: its header's message, then its chunks.
class SectionDigester {
 public:
  explicit SectionDigester(std::span<const std::byte> header);
  ~SectionDigester();
  SectionDigester(SectionDigester&&) noexcept;
  void add(const Digest& chunk);
  Digest digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace hapgrid
