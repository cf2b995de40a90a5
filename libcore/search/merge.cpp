#include "libcore/search/merge.hpp"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/search/levels.hpp"
#include "libcore/search/requests.hpp"

namespace hapgrid {

MergeInput merge_input(std::vector<Section> sections) {
  MergeInput input;
  bool any = false;
  for (Section& section : sections) {
    if (section.header.content == Content::kRequests) {
      input.requests.push_back(std::move(section));
      continue;
    }
    if (any)
      throw FormatError(
          format("{}: a second grid, beside {}", section.file->name(), input.grid.file->name()));
    any = true;
    input.grid = std::move(section);
  }
  if (!any)
    throw FormatError(format("{}: requests, but no grid to merge them into",
                             input.requests.front().file->name()));
  for (const Section& section : input.requests)
    if (section.header.generation != input.grid.header.generation)
      throw FormatError(format("{}: requests of generation {}, the grid's frontier is {}",
                               section.file->name(), section.header.generation,
                               input.grid.header.generation));
  return input;
}

SectionHeader MergeInput::merged_header() const {
  SectionHeader header = grid.header;
  if (grid.frontier() > 0) ++header.generation;
  return header;
}

namespace {

[[noreturn]] void fail_unasked(const GridSpec& spec, const SourceRequests& source) {
  throw FormatError(
      format("requests: {}, direction {}: the grid's frontier asks for no such conversion",
             describe(spec.box, source.point, source.level), std::countr_zero(source.directions)));
}

/// Copies a grid byte by byte, after a look at all of it.
void copy(const Section& grid, int fd, const std::string& name) {
  SectionReader reader(grid);
  RecordRows rows;
  for (std::size_t i = 0; i < grid.footer.chunks.size(); ++i) reader.read(i, rows);
  std::vector<std::byte> bytes;
  for (std::uint64_t at = grid.begin; at < grid.end; at += bytes.size()) {
    bytes.resize(std::min<std::uint64_t>(grid.end - at, 1 << 20));
    if (grid.file->read(at, bytes) != bytes.size())
      throw FormatError(format("{}: became shorter while it was read", grid.file->name()));
    write_all(fd, bytes, name);
  }
}

}  // namespace

void merge(const MergeInput& input, const Model& model, int fd, const std::string& name,
           Progress& progress) {
  const SectionHeader& header = input.grid.header;
  RequestReader requests(input.requests);
  SourceRequests source;
  if (input.grid.frontier() == 0) {
    if (requests.next(source)) fail_unasked(header.spec, source);
    return copy(input.grid, fd, name);
  }
  Levels levels(input.grid, model);
  while (requests.next(source)) {
    const RecordIndex record = levels.find(source.point, source.level);
    if (record == Grid::kNoRecord || levels.generation(record) != header.generation)
      fail_unasked(header.spec, source);
    levels.settle(record, source.directions, header.generation + 1,
                  [&source](int q) { return source.row(q); });
    progress.conversions += static_cast<std::uint64_t>(std::popcount(source.directions));
  }
  levels.require_settled(header.generation);
  SectionWriter out(fd, name, input.merged_header());
  levels.write(out);
}

void copy_finished(const Section& grid, SectionWriter& out) {
  if (grid.frontier() > 0)
    throw Error(
        format("{}: {} records are still in the frontier; only a finished grid can be made small",
               grid.file->name(), grid.frontier()));
  SectionReader reader(grid);
  RecordRows rows;
  for (std::size_t i = 0; i < grid.footer.chunks.size(); ++i) {
    reader.read(i, rows);
    out.records(rows, 0, rows.size());
  }
  out.finish();
}

}  // namespace hapgrid
