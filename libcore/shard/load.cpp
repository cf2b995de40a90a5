#include "libcore/shard/load.hpp"

#include "libcore/grid/grid_builder.hpp"
#include "libcore/shard/reader.hpp"

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

LoadedGrid load_grid(const std::string& name) { return load_grid(open_grid(name)); }

LoadedGrid load_grid(const Section& section) {
  const GridSpec& spec = section.header.spec;
  const std::uint64_t stored_bytes = section.end - section.begin;
  // A footer is not believed before its section was read: memory is taken at once only where the
  // claim is in proportion to the size of the shard; else it grows with the rows that come.
  const std::uint64_t records = section.records();
  const bool plausible = records <= kMaxRatio * stored_bytes / record_bytes(spec.row_size());
  GridBuilder grid(spec, section.header.generation, section.header.has_tears,
                   plausible ? records : 0);
  SectionReader reader(section);
  RecordRows rows;
  for (std::size_t i = 0; i < section.footer.chunks.size(); ++i) {
    reader.read(i, rows);
    grid.add({rows.point, rows.level, rows.generation, rows.numbers, rows.links, rows.tears});
  }
  return {grid.finish(), stored_bytes, digest_text(section.footer.digest)};
}

}  // namespace hapgrid
