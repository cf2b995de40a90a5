#include "libcore/search/complete.hpp"

#include <algorithm>
#include <bit>

#include "libcore/search/levels.hpp"
#include "libcore/search/merge.hpp"
#include "libcore/search/tears.hpp"
#include "libcore/shard/reader.hpp"

namespace hapgrid {

namespace {

using Frontier = std::vector<Levels::Stored>;

/// Appends a grid; answers its frontier.
Frontier load(const Section& grid, Levels& levels) {
  Frontier frontier;
  SectionReader reader(grid);
  RecordRows rows;
  for (std::size_t i = 0; i < grid.footer.chunks.size(); ++i) {
    reader.read(i, rows);
    levels.append(rows);
    for (std::size_t r = 0; r < rows.size(); ++r)
      if (rows.generation[r] == grid.header.generation)
        frontier.push_back({rows.point[r], rows.level[r]});
  }
  return frontier;
}

void show(const Frontier& frontier, const Neighbourhood& neighbourhood, const Levels& levels,
          std::uint32_t generation, Progress& progress) {
  std::uint64_t conversions = 0;
  for (const Levels::Stored& record : frontier)
    conversions += static_cast<std::uint64_t>(std::popcount(neighbourhood.inside(record.point)));
  progress.generation = generation;
  progress.frontier_records = frontier.size();
  progress.frontier_done = 0;
  progress.frontier_conversions = conversions;
  progress.records = levels.records();
}

/// The records, which leave `levels`.
Grid take_grid(const SectionHeader& header, Levels& levels) {
  RecordColumns columns;
  for (std::uint64_t b = 0; b < levels.blocks(); ++b) {
    levels.visit(b, [&](const RecordRows& rows, std::size_t begin, std::size_t end) {
      const auto append = [&](auto& out, const auto& in, std::size_t each) {
        const auto own = in.subspan(begin * each, (end - begin) * each);
        out.insert(out.end(), own.begin(), own.end());
      };
      append(columns.point, rows.point, 1);
      append(columns.level, rows.level, 1);
      append(columns.generation, rows.generation, 1);
      append(columns.rows, rows.numbers, rows.width);
      append(columns.links, rows.links, kDirections);
    });
    levels.release(b);
  }
  return {header.spec, header.generation, std::move(columns)};
}

}  // namespace

void complete(const Section& grid, Converter& converter, Progress& progress,
              const std::function<SectionWriter(const SectionHeader&)>& open) {
  SectionHeader header = grid.header;
  if (header.has_tears) {
    SectionWriter out = open(header);
    return copy_finished(grid, out);
  }
  Levels levels(header.spec, converter.model());
  const Neighbourhood neighbourhood(header.spec.box);
  Batch batch(header.spec);
  const std::size_t width = header.spec.row_size();
  Frontier frontier = load(grid, levels);
  Frontier found;
  const auto finish_batch = [&] {
    converter.convert(batch);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const double* const reached = batch.reached(i);
      levels.settle(
          levels.find(batch.point(i), batch.level(i)), batch.todo(i), header.generation,
          [&](int q) { return reached + static_cast<unsigned>(q) * width; },
          [&found](const Levels::Stored& record) { found.push_back(record); });
    }
    batch.clear();
  };
  for (; !frontier.empty(); frontier.swap(found)) {
    show(frontier, neighbourhood, levels, header.generation, progress);
    ++header.generation;
    found.clear();
    for (const Levels::Stored& record : frontier) {
      batch.add(record.point, record.level, levels.state(levels.find(record.point, record.level)),
                neighbourhood.inside(record.point));
      if (batch.is_full()) finish_batch();
    }
    finish_batch();
    std::sort(found.begin(), found.end());
  }
  show(frontier, neighbourhood, levels, header.generation, progress);

  if (header.lacks_tears()) {
    const Grid finished = take_grid(header, levels);
    const std::vector<OneWayLink> links = one_way_links(finished);
    const std::vector<TearByte> tears = find_tears(finished, links, converter, progress);
    header.has_tears = true;
    SectionWriter out = open(header);
    return write_torn_grid(finished, links, tears, out);
  }
  SectionWriter out = open(header);
  for (std::uint64_t b = 0; b < levels.blocks(); ++b) {
    levels.visit(b, [&out](const RecordRows& records, std::size_t begin, std::size_t end) {
      out.records(records, begin, end);
    });
    levels.release(b);
  }
  out.finish();
}

}  // namespace hapgrid
