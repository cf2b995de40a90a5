#include "libcore/search/complete.hpp"

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
  Wavefront wave(header.spec);
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
      conversions +=
          static_cast<std::uint64_t>(std::popcount(wave.neighbourhood().inside(record.point)));
    progress.generation = header.generation;
    progress.frontier_records = frontier.size();
    progress.frontier_done = 0;
    progress.frontier_conversions = conversions;
    progress.records = levels.records();

    const std::uint32_t generation = header.generation + 1;
    const auto settle = [&](PointIndex target, int q, Wavefront::Slot slot, const double* row) {
      if (levels.settle(target, q, wave.level(slot), row, generation))
        found.push_back(levels.last_stored());
    };
    found.clear();
    Wavefront::Slot converted = wave.end();
    for (const Levels::Stored& record : frontier) {
      wave.add(record.point, record.level, levels.state(record.point, record.level),
               wave.neighbourhood().inside(record.point));
      if (wave.end() - converted < wave.batch_size()) continue;
      converter.convert(wave, converted, wave.end());
      converted = wave.end();
      wave.drain(wave.settled_before(record.point), settle);
    }
    converter.convert(wave, converted, wave.end());
    wave.drain(header.spec.box.points(), settle);
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
