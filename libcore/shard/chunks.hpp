// All chunks of a grid's section, in threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <vector>

#include "libcore/base/parallel.hpp"
#include "libcore/shard/reader.hpp"

namespace hapgrid {

/// A footer is not believed before its section was read: where its claim is out of proportion to
/// the size of the shard, reads all chunks, so that memory can be taken for what it says.
/// @throw FormatError
void require_plausible(const Section& section);

/// Calls use(chunk, first, rows) for each chunk of records, where `first` is the number of its
/// first record in the section; from several threads and in no particular order.
/// @throw what reading or `use` throws, of the first chunk for which either does: whatever the
/// threads, the same damage is told.
template <class Use>
void for_each_chunk(const Section& section, const Use& use, int threads = all_threads()) {
  const std::vector<ChunkInfo>& chunks = section.footer.chunks;
  std::vector<std::uint64_t> first(chunks.size());
  for (std::size_t i = 1; i < chunks.size(); ++i) first[i] = first[i - 1] + chunks[i - 1].rows;
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::size_t failed = chunks.size();
  std::exception_ptr failure;
  const auto work = [&](std::size_t) {
    SectionReader reader(section);
    RecordRows rows;
    for (std::size_t i; (i = next++) < chunks.size();) try {
        reader.read(i, rows);
        use(i, first[i], rows);
      } catch (...) {
        const std::lock_guard lock(mutex);
        next = chunks.size();  // all before this one are being read, or were
        if (i < failed) {
          failed = i;
          failure = std::current_exception();
        }
      }
  };
  const auto useful = std::min(static_cast<std::size_t>(threads), chunks.size());
  for_each_in_threads(useful, static_cast<int>(useful), work);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace hapgrid
