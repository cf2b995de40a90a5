// All that is read of a shard: for the two targets that get to it from bytes and from messages.
#pragma once

#include "libcore/check/invariants.hpp"
#include "libcore/check/tears.hpp"
#include "libcore/haptic/paper_traversal.hpp"
#include "libcore/shard/load.hpp"
#include "libcore/shard/reader.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace hapgrid::fuzz {

/// The rows of a section, chunk by chunk, as expand and merge read them.
template <class Rows>
void read_rows(const Section& section) {
  SectionReader reader(section);
  Rows rows;
  for (std::size_t i = 0; i < section.footer.chunks.size(); ++i)
    refusable([&] { reader.read(i, rows); });
}

/// A grid as it is copied.
inline void read_stored(const Section& section) {
  SectionReader reader(section);
  StoredChunk chunk;
  for (std::size_t i = 0; i < section.footer.chunks.size(); ++i)
    refusable([&] { reader.read_stored(i, chunk); });
}

/// The grid as play takes it, whatever its links are: along a diagonal of its box and back, a jump,
/// and no number.
inline void play(const Grid& grid) {
  const Box& box = grid.spec().box;
  PaperTraversal traversal(grid);
  const auto place = [&](double share) {
    Vec3 x{};
    for (int a = 0; a < 3; ++a) x[a] = box.origin[a] + share * box.spacing * (box.counts[a] - 1);
    return x;
  };
  traversal.start(place(0.5));
  for (int i = 0; i <= 40; ++i) traversal.step(place(0.5 + 0.03 * (i <= 20 ? i : 40 - i)));
  traversal.step(place(0));
  traversal.step(place(std::numeric_limits<double>::quiet_NaN()));
}

inline void read_shard(std::span<const std::byte> bytes) {
  bool small = true;  // tables of millions of points take the time and show nothing new
  refusable([&] {
    MemoryFile memory(bytes);
    for (const Section& section : open_sections({memory.name()})) {
      small = small && section.header.spec.box.points() <= 1 << 16;
      if (section.header.content == Content::kRequests) {
        read_rows<RequestRows>(section);
      } else if (section.header.content == Content::kTears) {
        read_rows<TearRows>(section);
      } else {
        read_rows<RecordRows>(section);
        read_stored(section);
      }
    }
  });
  if (!small) return;
  refusable([&] {
    MemoryFile memory(bytes);
    const Grid grid = load_grid(memory.name()).grid;
    check_complete(grid, 1);
    check_links(grid, 1);
    if (grid.has_tears()) check_fractions(grid);
    check_finite(grid, 1);
    check_reachable(grid);
    check_blends(grid, 1);
    play(grid);
  });
}

}  // namespace hapgrid::fuzz
