#include "libcore/search/complete.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/search/expand.hpp"
#include "libcore/search/levels.hpp"
#include "libcore/shard/reader.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

namespace {

// What a shorter search has found is found again as fast as it is read.
constexpr std::chrono::seconds kLeastWork{1};
// A search works this many times as long as the last write took before the next write, so that
// writes take 3 % of its time at most.
constexpr int kWorkForWrite = 33;

/// Whether `later` has all records of `earlier`, and else only those of later generations. The
/// links of the last generation of `earlier` were not settled yet.
bool grew_from(const Grid& later, const Grid& earlier) {
  RecordIndex known = 0;
  for (RecordIndex found = 0; found < later.records(); ++found) {
    const std::uint32_t generation = later.record_generation(found);
    if (generation > earlier.generation()) continue;
    const RecordIndex r = known++;
    if (r == earlier.records() || later.point(found) != earlier.point(r) ||
        later.level(found) != earlier.level(r) || generation != earlier.record_generation(r) ||
        std::memcmp(later.row(found).data(), earlier.row(r).data(),
                    later.row(found).size_bytes()) != 0)
      return false;
    if (!earlier.in_frontier(r) && !std::ranges::equal(later.links(found), earlier.links(r)))
      return false;
  }
  return known == earlier.records();
}

}  // namespace

PartialGrid::PartialGrid(std::string name, std::function<void(const std::string&)> tell)
    : name_(std::move(name)), tell_(std::move(tell)), due_(Clock::now() + kLeastWork) {}

Section PartialGrid::start(const Section& grid) {
  const auto type = std::filesystem::symlink_status(name_).type();
  if (type == std::filesystem::file_type::not_found) return grid;
  const char* const remove = "; remove it to begin anew";
  // Nobody has put anything else there for a good reason: a link would have us read what it names.
  if (type != std::filesystem::file_type::regular)
    throw FormatError(format("{}: is no regular file{}", name_, remove));
  Section file = open_grid(name_);
  GridSpec spec = file.header.spec;
  const std::uint32_t limit = std::exchange(spec.max_levels, grid.header.spec.max_levels);
  if (spec != grid.header.spec)
    throw FormatError(format("{}: another grid than {}: {}{}", name_, grid.file->name(),
                             difference(spec, grid.header.spec), remove));
  if (limit > spec.max_levels)
    throw FormatError(format("{}: was found with a level limit of {}, which is now {}{}", name_,
                             limit, spec.max_levels, remove));
  if (!grew_from(load_grid(file), load_grid(grid)))
    throw FormatError(
        format("{}: did not grow from {}, which has other seeds or is of a later generation{}",
               name_, grid.file->name(), remove));
  file.header.spec.max_levels = spec.max_levels;
  kept_ = file.header.generation;
  return file;
}

void PartialGrid::write_checkpoint(const SectionHeader& header, const Levels& levels) {
  const Clock::time_point begin = Clock::now();
  OutputFile out = OutputFile::replacing(name_);
  SectionWriter writer(out.fd(), out.name(), header);
  levels.write(writer);
  out.commit();
  kept_ = header.generation;
  const Clock::time_point end = Clock::now();
  due_ = end + std::max<Clock::duration>(kLeastWork, kWorkForWrite * (end - begin));
}

void PartialGrid::write_checkpoint_if_due(const SectionHeader& header, const Levels& levels) {
  if (Clock::now() < due_) return;
  try {
    write_checkpoint(header, levels);
  } catch (const std::exception& e) {
    due_ = Clock::now() + kLeastWork;
    if (!std::exchange(complained_, true))
      tell_(std::string("cannot keep what is found: ") + e.what());
  }
}

void PartialGrid::remove() {
  if (kept_) std::filesystem::remove(name_);
}

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
  for (const RecordIndex r : frontier) {
    conversions += static_cast<std::uint64_t>(std::popcount(neighbourhood.inside(levels.point(r))));
    progress.points += levels.level(r) == 0;
  }
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
  for (RecordIndex r = 0; r < levels.records(); ++r)
    progress.points += levels.level(r) == 0 && levels.generation(r) != header.generation;
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
        [&](const FrontierRecord& record, const double* rows) {
          levels.settle(*source++, record.todo, header.generation,
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
