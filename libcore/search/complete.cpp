#include "libcore/search/complete.hpp"

#include <algorithm>
#include <bit>

#include "libcore/base/format.hpp"
#include "libcore/search/expand.hpp"
#include "libcore/search/levels.hpp"

namespace hapgrid {

namespace {

/// The records from number `from` on that are of a generation, ascending by (point, level).
std::vector<RecordIndex> frontier_of(const Levels& levels, RecordIndex from,
                                     std::uint32_t generation) {
  std::vector<RecordIndex> frontier;
  for (RecordIndex r = from; r < levels.records(); ++r)
    if (levels.generation(r) == generation) frontier.push_back(r);
  std::sort(frontier.begin(), frontier.end(), [&](RecordIndex a, RecordIndex b) {
    return record_key(levels.point(a), levels.level(a)) <
           record_key(levels.point(b), levels.level(b));
  });
  return frontier;
}

void show(const std::vector<RecordIndex>& frontier, const Neighbourhood& neighbourhood,
          const Levels& levels, std::uint32_t generation, Progress& progress) {
  std::uint64_t conversions = 0;
  for (const RecordIndex r : frontier)
    conversions += static_cast<std::uint64_t>(std::popcount(neighbourhood.inside(levels.point(r))));
  progress.generation = generation;
  progress.frontier_records = frontier.size();
  progress.frontier_done = 0;
  progress.frontier_conversions = conversions;
  progress.records = levels.records();
}

/// Rounds in memory until the frontier is empty. Counts generations in `header`.
void run_rounds(SectionHeader& header, Levels& levels, Converter& converter, Progress& progress,
                PartialGrid* partial) {
  const Neighbourhood neighbourhood(header.spec.box);
  const std::size_t width = header.spec.row_size();
  std::vector<RecordIndex> frontier = frontier_of(levels, 0, header.generation);
  while (!frontier.empty()) {
    show(frontier, neighbourhood, levels, header.generation, progress);
    ++header.generation;
    const RecordIndex known = levels.records();
    auto next = frontier.begin();
    auto source = frontier.begin();  // of the conversions that come next
    expand(
        [&](FrontierRecord& record) {
          if (next == frontier.end()) return false;
          const RecordIndex r = *next++;
          const PointIndex point = levels.point(r);
          record = {point, levels.level(r), levels.state(r), neighbourhood.inside(point)};
          return true;
        },
        converter, header.spec,
        [&](PointIndex, Level, DirectionMask directions, const double* rows) {
          levels.settle(*source++, directions, header.generation,
                        [&](int q) { return rows + static_cast<unsigned>(q) * width; });
        });
    frontier = frontier_of(levels, known, header.generation);
    if (partial) partial->write_checkpoint_if_due(header, levels);
  }
  show(frontier, neighbourhood, levels, header.generation, progress);
}

/// Where the search can go on from after an error, for its message.
std::string what_is_kept(const PartialGrid* partial, const char* nothing, const char* how = "") {
  if (!partial) return "";
  if (!partial->kept()) return nothing;
  return format("; {} keeps generation {}, from which the same command goes on{}", partial->name(),
                *partial->kept(), how);
}

/// Calls work(). @throw what it throws; the message of an Error says what is kept
template <class Work>
void tell_what_is_kept(const PartialGrid* partial, Work&& work) {
  try {
    work();
  } catch (const Stopped&) {
    throw Stopped(what_is_kept(partial, "; nothing is kept"));
  } catch (const LevelLimit& e) {
    throw LevelLimit(
        e.what() + what_is_kept(partial, "",
                                ", also when the grid is seeded with a larger search.max_levels"));
  } catch (const ModelError& e) {
    throw ModelError(e.what() + what_is_kept(partial, ""));
  } catch (const Error& e) {
    throw Error(e.what() + what_is_kept(partial, ""));
  }
}

}  // namespace

void complete(const Section& grid, Converter& converter, Progress& progress,
              const std::function<SectionWriter(const SectionHeader&)>& open,
              PartialGrid* partial) {
  SectionHeader header = grid.header;
  Levels levels(grid, converter.model());
  tell_what_is_kept(partial, [&] { run_rounds(header, levels, converter, progress, partial); });
  SectionWriter out = open(header);
  levels.write(out);
}

}  // namespace hapgrid
