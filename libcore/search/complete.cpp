#include "libcore/search/complete.hpp"

#include <algorithm>
#include <bit>

#include "libcore/search/levels.hpp"
#include "libcore/shard/merged_rows.hpp"

namespace hapgrid {

void complete(const std::vector<Section>& sections, Converter& converter, Progress& progress,
              const std::function<SectionWriter(const SectionHeader&)>& open) {
  require_content(sections, Content::kGrid);
  SectionHeader header = sections.front().header;
  header.generation = generation_of(sections);
  header.coding = {};
  Levels levels(header.spec, converter.model());
  const Neighbourhood neighbourhood(header.spec.box);
  Batch batch(header.spec);
  const std::size_t width = header.spec.row_size();
  std::vector<Levels::Stored> frontier;

  MergedRows<RecordRows> rows(sections);
  for (Run<RecordRows> run = rows.next(); run.rows; run = rows.next()) {
    const RecordRows& in = *run.rows;
    levels.append(in, run.begin, run.end);
    for (std::size_t r = run.begin; r < run.end; ++r)
      if (in.generation[r] == header.generation) frontier.push_back({in.point[r], in.level[r]});
  }

  std::vector<Levels::Stored> found;
  while (!frontier.empty()) {
    std::uint64_t conversions = 0;
    for (const Levels::Stored& record : frontier)
      conversions += static_cast<std::uint64_t>(std::popcount(neighbourhood.inside(record.point)));
    progress.generation = header.generation;
    progress.frontier_records = frontier.size();
    progress.frontier_done = 0;
    progress.frontier_conversions = conversions;
    progress.records = levels.records();

    const std::uint32_t generation = header.generation + 1;
    const auto finish_batch = [&] {
      converter.convert(batch);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        const double* const reached = batch.reached(i);
        levels.settle(
            levels.find(batch.point(i), batch.level(i)), batch.todo(i), generation,
            [&](int q) { return reached + static_cast<unsigned>(q) * width; },
            [&found](const Levels::Stored& record) { found.push_back(record); });
      }
      batch.clear();
    };
    found.clear();
    for (const Levels::Stored& record : frontier) {
      batch.add(record.point, record.level, levels.state(levels.find(record.point, record.level)),
                neighbourhood.inside(record.point));
      if (batch.is_full()) finish_batch();
    }
    finish_batch();
    std::sort(found.begin(), found.end());
    frontier.swap(found);
    header.generation = generation;
  }
  progress.records = levels.records();
  progress.frontier_records = 0;

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
