// Memory for columns of a grid, which can have gigabytes.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace hapgrid {

/// `size` values, which are not initialised: so it is the threads that fill an array that wait for
/// its pages, and what nobody writes takes no memory. Large arrays ask for large pages, which take
/// less time to come and to be found.
template <class T>
class LargeArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  LargeArray() = default;
  explicit LargeArray(std::size_t size) : size_(size) {
    constexpr std::size_t kPage = 2 << 20;
    const std::size_t bytes = size * sizeof(T);
    const bool is_large = bytes >= 2 * kPage;
    const std::size_t align = is_large ? kPage : 64;
    if (size > 0) {
      memory_.reset(
          static_cast<T*>(std::aligned_alloc(align, (bytes + align - 1) / align * align)));
      if (!memory_) throw std::bad_alloc();
    }
    if (is_large) ::madvise(memory_.get(), bytes, MADV_HUGEPAGE);
  }
  LargeArray(LargeArray&& other) noexcept
      : memory_(std::move(other.memory_)), size_(std::exchange(other.size_, 0)) {}
  LargeArray& operator=(LargeArray&& other) noexcept {
    memory_ = std::move(other.memory_);
    size_ = std::exchange(other.size_, 0);
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return memory_.get(); }
  const T* data() const { return memory_.get(); }
  T& operator[](std::size_t i) { return memory_.get()[i]; }
  const T& operator[](std::size_t i) const { return memory_.get()[i]; }

 private:
  struct Free {
    void operator()(T* memory) const { std::free(memory); }
  };
  std::unique_ptr<T, Free> memory_;
  std::size_t size_ = 0;
};

}  // namespace hapgrid
