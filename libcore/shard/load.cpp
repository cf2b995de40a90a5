#include "libcore/shard/load.hpp"

#include <span>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/shard/merged_rows.hpp"

namespace hapgrid {

namespace {
// zstd makes at most some thousand bytes out of one.
constexpr std::uint64_t kMaxRatio = 4096;

/// The section's own, or of several one of theirs.
std::string digest_text(const std::vector<Section>& sections) {
  std::vector<Digest> digests;
  for (const Section& section : sections) digests.push_back(section.footer.digest);
  const Digest digest =
      digests.size() == 1 ? digests.front() : digest_of(std::as_bytes(std::span(digests)));
  char text[33];
  for (int i = 0; i < 32; ++i) {
    const std::uint64_t half = i < 16 ? digest.high : digest.low;
    text[i] = "0123456789abcdef"[half >> (60 - 4 * (i % 16)) & 15];
  }
  return {text, 32};
}
}  // namespace

LoadedGrid load_grid(const std::vector<std::string>& names) {
  const std::vector<Section> sections = open_sections(names);
  require_content(sections, Content::kGrid);
  std::uint64_t records = 0;
  std::uint64_t stored_bytes = 0;
  for (const Section& section : sections) {
    records += section.footer.records;
    stored_bytes += section.stored_bytes;
  }
  const SectionHeader& header = sections.front().header;
  require_same_precision(sections);
  const std::uint32_t width = header.spec.row_size();
  RecordColumns columns;
  // A footer is not believed before its section was read: memory is taken at once only where the
  // claim is in proportion to the size of the shards; else it grows with the rows that come.
  const bool plausible = records <= kMaxRatio * stored_bytes / record_bytes(width);
  const std::size_t expected = plausible ? records : 0;
  columns.point.reserve(expected);
  columns.level.reserve(expected);
  columns.generation.reserve(expected);
  columns.rows.reserve(expected * width);
  columns.links.reserve(expected * kDirections);
  MergedRows<RecordRows> rows(sections);
  for (Run<RecordRows> run = rows.next(); run.rows; run = rows.next()) {
    const auto append = [&run](auto& out, const auto& in, std::size_t each) {
      out.insert(out.end(), in.begin() + static_cast<std::ptrdiff_t>(run.begin * each),
                 in.begin() + static_cast<std::ptrdiff_t>(run.end * each));
    };
    append(columns.point, run.rows->point, 1);
    append(columns.level, run.rows->level, 1);
    append(columns.generation, run.rows->generation, 1);
    append(columns.rows, run.rows->numbers, width);
    append(columns.links, run.rows->links, kDirections);
  }
  return {Grid(header.spec, generation_of(sections), std::move(columns)), header.coding,
          stored_bytes, digest_text(sections)};
}

}  // namespace hapgrid
