// The mutator of files that are messages (messages.hpp). Of eight mutations one is of the file's
// bytes, as libFuzzer does it; the others change the messages, and then all sizes, digests and zstd
// frames are right again.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include "tests/fuzz/messages.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace hapgrid::fuzz {

class MessageMutator {
  int below(std::size_t n) { return static_cast<int>(random_() % n); }
  template <class List>
  auto& any(List& list) {
    return list[static_cast<std::size_t>(below(list.size()))];
  }

 public:
  MessageMutator(FitFooter fit, unsigned seed) : fit_(fit), random_(seed) {}

  /// Changes the `size` bytes of a file in place, which has room for `max_size`; answers the new
  /// size.
  std::size_t mutate(std::uint8_t* data, std::size_t size, std::size_t max_size) {
    if (below(8) == 0) return LLVMFuzzerMutate(data, size, max_size);
    Parts parts = take_apart(std::as_bytes(std::span(data, size)));
    if (parts.sections.empty()) return LLVMFuzzerMutate(data, size, max_size);
    for (std::size_t times = 1 + below(3); times > 0; --times) change(parts);
    const std::size_t changed = write(std::move(parts), {data, max_size});
    return changed > 0 ? changed : LLVMFuzzerMutate(data, size, max_size);
  }

  /// Writes the first file with some messages of the second one to `out`; answers how many bytes,
  /// or 0 where that cannot be.
  std::size_t cross_over(std::span<const std::uint8_t> first, std::span<const std::uint8_t> second,
                         std::span<std::uint8_t> out) {
    Parts parts = take_apart(std::as_bytes(first));
    const Parts other = take_apart(std::as_bytes(second));
    if (parts.sections.empty() || other.sections.empty()) return 0;
    const Messages& from = any(other.sections);
    if (below(4) == 0) {
      parts.sections.insert(parts.sections.begin() + below(parts.sections.size() + 1), from);
    } else {
      any(any(parts.sections).all) = any(from.all);
    }
    return write(std::move(parts), out);
  }

 private:
  void change(Parts& parts) {
    Messages& section = any(parts.sections);
    Words& message = any(section.all);
    switch (below(8)) {
      case 0:
        return change_list(parts, section);
      case 1:
      case 2:
      case 3:
        return change_word(message);
      default:
        return change_bytes(message);
    }
  }

  /// A message or a section is dropped, repeated, or exchanged with another.
  void change_list(Parts& parts, Messages& section) {
    std::vector<Words>& all = section.all;
    const int at = below(all.size());
    switch (below(5)) {
      case 0:
        if (all.size() > 1) all.erase(all.begin() + at);
        return;
      case 1:
        all.insert(all.begin() + at, Words(all[static_cast<std::size_t>(at)]));
        return;
      case 2:
        std::swap(any(all), any(all));
        return;
      case 3:
        section.has_footer = !section.has_footer;
        return;
      default:
        std::swap(any(parts.sections), any(parts.sections));
    }
  }

  /// Cap'n Proto's pointers and Float64 columns are words of eight bytes, its counts half of one.
  void change_word(Words& message) {
    static constexpr std::array<std::uint64_t, 12> kWords{
        0,
        1,
        0xffffffffffffffff,
        0x7ff0000000000000,  // inf
        0xfff0000000000000,
        0x7ff8000000000000,  // nan
        0x7fefffffffffffff,  // the largest number, and the least
        0x0000000000000001,
        0x8000000000000000,
        0x3ff0000000000000,  // 1
        0x00000000ffffffff,
        0xfefefefefefefefe  // links that are not settled
    };
    std::uint64_t& word = any(message);
    switch (below(5)) {
      case 0:
        word = kWords[static_cast<std::size_t>(below(kWords.size()))];
        return;
      case 1:
        word = any(message);
        return;
      case 2:
        word += static_cast<std::uint64_t>(below(33)) - 16;
        return;
      case 3:
        word += (static_cast<std::uint64_t>(below(33)) - 16) << 32;
        return;
      default:
        word ^= std::uint64_t{1} << below(64);
    }
  }

  /// libFuzzer's own mutations; the message's last word is filled up with zeros.
  void change_bytes(Words& message) {
    constexpr std::size_t kGrowth = 16;
    const std::size_t size = message.size() * sizeof(std::uint64_t);
    message.resize(message.size() + kGrowth);
    const std::size_t changed = LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(message.data()),
                                                 size, message.size() * sizeof(std::uint64_t));
    auto* const bytes = reinterpret_cast<std::uint8_t*>(message.data());
    std::fill(bytes + changed, bytes + message.size() * sizeof(std::uint64_t), std::uint8_t{0});
    message.resize(std::max<std::size_t>(1, (changed + 7) / sizeof(std::uint64_t)));
  }

  std::size_t write(Parts parts, std::span<std::uint8_t> out) {
    const std::vector<std::byte> file = put_together(std::move(parts), fit_);
    if (file.size() > out.size()) return 0;
    std::memcpy(out.data(), file.data(), file.size());
    return file.size();
  }

  FitFooter fit_;
  std::minstd_rand random_;
};

}  // namespace hapgrid::fuzz

/// Defines what libFuzzer looks for in a target whose files are messages.
#define HAPGRID_FUZZ_MESSAGES(fit)                                                       \
  extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,   \
                                                 std::size_t max_size, unsigned seed) {  \
    return hapgrid::fuzz::MessageMutator(fit, seed).mutate(data, size, max_size);        \
  }                                                                                      \
  extern "C" std::size_t LLVMFuzzerCustomCrossOver(                                      \
      const std::uint8_t* first, std::size_t first_size, const std::uint8_t* second,     \
      std::size_t second_size, std::uint8_t* out, std::size_t out_size, unsigned seed) { \
    return hapgrid::fuzz::MessageMutator(fit, seed).cross_over(                          \
        {first, first_size}, {second, second_size}, {out, out_size});                    \
  }
