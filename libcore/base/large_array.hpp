// Memory for columns of a grid, which can have gigabytes.
#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace hapgrid {

/// `size` values whose bytes are 0 at first. Nothing is written for that in a large array: so it is
/// the threads that fill it that wait for its pages, and what nobody writes takes no memory. Large
/// arrays ask for large pages, which take less time to come and to be found.
template <class T>
class LargeArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  LargeArray() = default;
  explicit LargeArray(std::size_t size) : size_(size) {
    const std::size_t bytes = size * sizeof(T);
    if (bytes >= 2 * kPage)
      map(bytes);
    else if (size > 0)
      memory_.reset(static_cast<T*>(std::aligned_alloc(64, (bytes + 63) / 64 * 64)));
    if (size > 0 && !memory_) throw std::bad_alloc();
    if (bytes < 2 * kPage && size > 0) std::memset(static_cast<void*>(memory_.get()), 0, bytes);
  }
  LargeArray(LargeArray&& other) noexcept
      : memory_(std::move(other.memory_)), size_(std::exchange(other.size_, 0)) {}
  LargeArray& operator=(LargeArray&& other) noexcept {
    memory_ = std::move(other.memory_);
    size_ = std::exchange(other.size_, 0);
    return *this;
  }

  /// Forgets all but the first `size` values. Of a large array the others give their memory back,
  /// also what was never written: a program that locks its memory would get it.
  void keep(std::size_t size) {
    size_ = size;
    std::size_t& mapped = memory_.get_deleter().mapped;
    const std::size_t kept = std::max(whole_pages(size * sizeof(T)), kPage);
    if (mapped <= kept) return;
    ::munmap(reinterpret_cast<std::byte*>(memory_.get()) + kept, mapped - kept);
    mapped = kept;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return memory_.get(); }
  const T* data() const { return memory_.get(); }
  T& operator[](std::size_t i) { return memory_.get()[i]; }
  const T& operator[](std::size_t i) const { return memory_.get()[i]; }

 private:
  static constexpr std::size_t kPage = 2 << 20;
  static std::size_t whole_pages(std::size_t bytes) { return (bytes + kPage - 1) / kPage * kPage; }

  struct Free {
    std::size_t mapped = 0;  // bytes; 0: allocated
    void operator()(T* memory) const {
      if (mapped > 0)
        ::munmap(memory, mapped);
      else
        std::free(memory);
    }
  };

  /// Whole large pages, so that each of them can be one. No memory: memory_ stays empty.
  void map(std::size_t bytes) {
    const std::size_t mapped = whole_pages(bytes);
    void* const all =
        ::mmap(nullptr, mapped + kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (all == MAP_FAILED) return;
    const std::size_t before = -reinterpret_cast<std::uintptr_t>(all) % kPage;
    std::byte* const begin = static_cast<std::byte*>(all) + before;
    if (before > 0) ::munmap(all, before);
    ::munmap(begin + mapped, kPage - before);
    ::madvise(begin, mapped, MADV_HUGEPAGE);
    memory_ = {reinterpret_cast<T*>(begin), Free{mapped}};
  }

  std::unique_ptr<T, Free> memory_;
  std::size_t size_ = 0;
};

}  // namespace hapgrid
