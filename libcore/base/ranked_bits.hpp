// A set of numbers that says how many of it are below a number: the index of a column that only
// some rows have.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hapgrid {

/// Two bits for each number below the size. Everything but the constructor is real-time safe.
class RankedBits {
 public:
  RankedBits() = default;
  /// @param words bit i % 64 of word i / 64: whether i is in the set, which has less than 2^32
  explicit RankedBits(const std::vector<std::uint64_t>& words) {
    blocks_.reserve(words.size());
    for (const std::uint64_t word : words) {
      blocks_.push_back({word, count_});
      count_ += static_cast<std::uint32_t>(std::popcount(word));
    }
  }

  bool empty() const { return blocks_.empty(); }
  std::uint32_t count() const { return count_; }
  bool has(std::size_t i) const { return blocks_[i / 64].bits >> i % 64 & 1; }
  /// How many of the set are below i.
  std::uint32_t rank(std::size_t i) const {
    const Block& block = blocks_[i / 64];
    const std::uint64_t below = block.bits & ((std::uint64_t{1} << i % 64) - 1);
    return block.before + static_cast<std::uint32_t>(std::popcount(below));
  }
  std::size_t words() const { return blocks_.size(); }
  /// Calls use(i) for each i of the set in words [begin, end), ascending.
  template <class Use>
  void for_each(std::size_t begin, std::size_t end, Use&& use) const {
    for (std::size_t w = begin; w < end; ++w)
      for (std::uint64_t bits = blocks_[w].bits; bits != 0; bits &= bits - 1)
        use(w * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
  }

 private:
  struct Block {
    std::uint64_t bits;
    std::uint32_t before;  // of the set, below this block
  };
  std::vector<Block> blocks_;
  std::uint32_t count_ = 0;
};

}  // namespace hapgrid
