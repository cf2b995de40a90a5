#include "libcore/shard/load.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <vector>

#include "libcore/base/format.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/grid/grid_builder.hpp"
#include "libcore/shard/reader.hpp"

namespace hapgrid {

namespace {

// zstd makes at most some thousand bytes out of one.
constexpr std::uint64_t kMaxRatio = 4096;

/// Calls use(first, rows) for each chunk of a grid's section, where `first` is the number of its
/// first record in the section; from several threads and in no particular order.
/// @throw what reading or `use` throws, of the first chunk for which either does: so the same
/// damage gives the same message, whatever the threads.
template <class Use>
void for_each_chunk(const Section& section, const Use& use) {
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
        use(first[i], rows);
      } catch (...) {
        const std::lock_guard lock(mutex);
        next = chunks.size();  // all before this one are being read, or were
        if (i < failed) {
          failed = i;
          failure = std::current_exception();
        }
      }
  };
  const auto useful = std::min(static_cast<std::size_t>(all_threads()), chunks.size());
  for_each_in_threads(useful, static_cast<int>(useful), work);
  if (failure) std::rethrow_exception(failure);
}

/// The footer says how much memory the grid takes. Where that is out of proportion to the size of
/// the section, this reads all chunks first, because a hostile footer can claim anything.
/// @throw FormatError
void require_plausible(const Section& section) {
  const std::uint64_t bytes = record_bytes(section.header.spec.row_size());
  if (section.records() > kMaxRatio * (section.end - section.begin) / bytes)
    for_each_chunk(section, [](std::uint64_t, const RecordRows&) {});
}

std::string digest_text(const Digest& digest) {
  return format("{:016x}{:016x}", digest.high, digest.low);
}

}  // namespace

LoadedGrid load_grid(const std::string& name) { return load_grid(open_grid(name)); }

LoadedGrid load_grid(const Section& section) {
  require_plausible(section);
  GridBuilder grid(section.header.spec, section.header.generation, section.records());
  for_each_chunk(section, [&](std::uint64_t first, const RecordRows& rows) {
    grid.add(first, {rows.point, rows.level, rows.generation, rows.numbers, rows.links});
  });
  return {grid.finish(), section.end - section.begin, digest_text(section.footer.digest)};
}

}  // namespace hapgrid
