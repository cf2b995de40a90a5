// Memory that is read here and there. A place of it is found the sooner, the fewer pages there are.
#pragma once

#ifdef __linux__  // a browser has no such pages
#include <sys/mman.h>
#endif

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hapgrid {

/// Reserves room for `count` values, in large pages if it is as large as two of them.
template <class T>
void reserve_large(std::vector<T>& values, std::size_t count) {
  values.reserve(count);
#ifdef __linux__
  constexpr std::uintptr_t kPage = 4096, kLargePage = 2 << 20;
  if (count * sizeof(T) < 2 * kLargePage) return;
  const auto begin = reinterpret_cast<std::uintptr_t>(values.data());
  const std::uintptr_t page = (begin + kPage - 1) / kPage * kPage;
  // Only advice: where the kernel has no large pages, small ones do.
  ::madvise(reinterpret_cast<void*>(page), begin + count * sizeof(T) - page, MADV_HUGEPAGE);
#endif
}

}  // namespace hapgrid
