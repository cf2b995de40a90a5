// A lock where there are threads; WebAssembly in a page has one thread.
#pragma once

#ifndef __wasm__
#include <mutex>
#endif

namespace hapgrid {

#ifdef __wasm__
struct Mutex {};
struct Lock {
  explicit Lock(Mutex&) {}
  ~Lock() {}
};
#else
using Mutex = std::mutex;
using Lock = std::lock_guard<Mutex>;
#endif

}  // namespace hapgrid
