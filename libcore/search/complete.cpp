#include "libcore/search/complete.hpp"

#include <algorithm>
#include <bit>

#include "libcore/base/format.hpp"
#include "libcore/grid/grid_builder.hpp"
#include "libcore/search/expand.hpp"
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
  for (const auto& [point, level] : frontier)
    conversions += static_cast<std::uint64_t>(std::popcount(neighbourhood.inside(point)));
  progress.generation = generation;
  progress.frontier_records = frontier.size();
  progress.frontier_done = 0;
  progress.frontier_conversions = conversions;
  progress.records = levels.records();
}

/// Moves the records out of `levels` into a grid.
Grid move_into_grid(const SectionHeader& header, Levels& levels) {
  GridBuilder grid(header.spec, header.generation, /*has_tears=*/false, levels.records());
  std::uint64_t added = 0;
  for (std::uint64_t b = 0; b < levels.blocks(); ++b) {
    levels.visit(b, [&](const RecordRows& rows, std::size_t begin, std::size_t end) {
      const auto run = [&](const auto& in, std::size_t each) {
        return in.subspan(begin * each, (end - begin) * each);
      };
      grid.add(added, {run(rows.point, 1),
                       run(rows.level, 1),
                       run(rows.generation, 1),
                       run(rows.numbers, rows.width),
                       run(rows.links, kDirections),
                       {}});
      added += end - begin;
    });
    levels.release(b);
  }
  return grid.finish();
}

/// Rounds in memory until the frontier is empty. Counts generations in `header`.
void run_rounds(SectionHeader& header, Levels& levels, Frontier frontier, Converter& converter,
                Progress& progress, PartialGrid* partial) {
  const Neighbourhood neighbourhood(header.spec.box);
  const std::size_t width = header.spec.row_size();
  while (!frontier.empty()) {
    show(frontier, neighbourhood, levels, header.generation, progress);
    ++header.generation;
    Frontier found;
    std::size_t next = 0;
    expand(
        [&](FrontierRecord& record) {
          if (next == frontier.size()) return false;
          const auto [point, level] = frontier[next++];
          record = {point, level, levels.state(levels.find(point, level)),
                    neighbourhood.inside(point)};
          return true;
        },
        converter, header.spec,
        [&](PointIndex point, Level level, DirectionMask directions, const double* rows) {
          levels.settle(
              levels.find(point, level), directions, header.generation,
              [&](int q) { return rows + static_cast<unsigned>(q) * width; },
              [&](const Levels::Stored& record) { found.push_back(record); });
        });
    std::sort(found.begin(), found.end());
    frontier.swap(found);
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
  if (grid.header.has_tears) {
    SectionWriter out = open(grid.header);
    return copy_finished(grid, out);
  }
  SectionHeader header = grid.header;
  Levels levels(header.spec, converter.model());
  Frontier frontier = load(grid, levels);
  tell_what_is_kept(partial, [&] {
    run_rounds(header, levels, std::move(frontier), converter, progress, partial);
  });
  if (!header.lacks_tears()) {
    SectionWriter out = open(header);
    return levels.write(out);
  }
  const Grid finished = move_into_grid(header, levels);
  const std::vector<OneWayLink> links = one_way_links(finished);
  std::vector<TearByte> tears;
  tell_what_is_kept(partial, [&] { tears = find_tears(finished, links, converter, progress); });
  header.has_tears = true;
  SectionWriter out = open(header);
  write_torn_grid(finished, links, tears, out);
}

}  // namespace hapgrid
