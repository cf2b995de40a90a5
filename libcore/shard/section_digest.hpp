// The digest of a section's decoded content.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "libcore/base/digest.hpp"

namespace hapgrid {

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
