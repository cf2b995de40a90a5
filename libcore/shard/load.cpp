#include "libcore/shard/load.hpp"

#include "libcore/grid/grid_builder.hpp"
#include "libcore/shard/chunks.hpp"

namespace hapgrid {

namespace {
// zstd makes at most some thousand bytes out of one.
constexpr std::uint64_t kMaxRatio = 4096;

std::string digest_text(const Digest& digest) {
  char text[33];
  for (int i = 0; i < 32; ++i) {
    const std::uint64_t half = i < 16 ? digest.high : digest.low;
    text[i] = "0123456789abcdef"[half >> (60 - 4 * (i % 16)) & 15];
  }
  return {text, 32};
}
}  // namespace

void require_plausible(const Section& section) {
  const std::uint64_t bytes = record_bytes(section.header.spec.row_size());
  if (section.records() > kMaxRatio * (section.end - section.begin) / bytes)
    for_each_chunk(section, [](std::size_t, std::uint64_t, const RecordRows&) {});
}

LoadedGrid load_grid(const std::string& name) { return load_grid(open_grid(name)); }

LoadedGrid load_grid(const Section& section) {
  require_plausible(section);
  GridBuilder grid(section.header.spec, section.header.generation, section.header.has_tears,
                   section.records());
  for_each_chunk(section, [&](std::size_t, std::uint64_t first, const RecordRows& rows) {
    grid.add(first,
             {rows.point, rows.level, rows.generation, rows.numbers, rows.links, rows.tears});
  });
  return {grid.finish(), section.end - section.begin, digest_text(section.footer.digest)};
}

}  // namespace hapgrid
