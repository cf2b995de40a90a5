#include "libcore/search/complete.hpp"

#include <algorithm>
#include <bit>

#include "libcore/grid/grid_builder.hpp"
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

/// The rounds, in memory.
class Rounds {
 public:
  Rounds(const Section& grid, Converter& converter, Progress& progress, PartialGrid* partial)
      : header_(grid.header),
        converter_(converter),
        progress_(progress),
        partial_(partial),
        levels_(header_.spec, converter.model()),
        neighbourhood_(header_.spec.box),
        batch_(header_.spec),
        frontier_(load(grid, levels_)) {}

  /// Until the frontier is empty.
  void run() {
    for (; !frontier_.empty(); frontier_.swap(found_)) {
      show(frontier_, neighbourhood_, levels_, header_.generation, progress_);
      whole_ = header_.generation++;
      found_.clear();
      keep_if_due();
      for (const Levels::Stored& record : frontier_) {
        batch_.add(record.point, record.level,
                   levels_.state(levels_.find(record.point, record.level)),
                   neighbourhood_.inside(record.point));
        if (batch_.is_full()) finish_batch();
      }
      finish_batch();
      std::sort(found_.begin(), found_.end());
    }
    whole_ = header_.generation;
    keep_if_due();
    show(frontier_, neighbourhood_, levels_, header_.generation, progress_);
  }

  /// After an error in run().
  void keep() {
    if (partial_) partial_->keep(whole_header(), levels_);
  }

  SectionHeader header() const { return header_; }
  Levels& levels() { return levels_; }

 private:
  SectionHeader whole_header() const {
    SectionHeader header = header_;
    header.generation = whole_;
    return header;
  }
  void keep_if_due() {
    if (partial_) partial_->keep_if_due(whole_header(), levels_);
  }
  void finish_batch() {
    converter_.convert(batch_);
    const std::size_t width = header_.spec.row_size();
    for (std::size_t i = 0; i < batch_.size(); ++i) {
      const double* const reached = batch_.reached(i);
      levels_.settle(
          levels_.find(batch_.point(i), batch_.level(i)), batch_.todo(i), header_.generation,
          [&](int q) { return reached + static_cast<unsigned>(q) * width; },
          [this](const Levels::Stored& record) { found_.push_back(record); });
    }
    batch_.clear();
    keep_if_due();
  }

  SectionHeader header_;
  Converter& converter_;
  Progress& progress_;
  PartialGrid* partial_;
  Levels levels_;
  Neighbourhood neighbourhood_;
  Batch batch_;
  Frontier frontier_;
  Frontier found_;
  std::uint32_t whole_ = 0;  // the last generation that is whole
};

/// Calls work(), and keep() when it throws.
/// @throw what work() throws; of an Error, the message says what is kept.
template <class Work, class Keep>
void kept(const PartialGrid* partial, Work&& work, Keep&& keep) {
  const auto what_is_kept = [&](const char* how) {
    return partial && partial->kept()
               ? "; " + partial->name() + " keeps generation " + std::to_string(*partial->kept()) +
                     ", from which the same command goes on" + how
               : std::string();
  };
  try {
    work();
  } catch (const Stopped&) {
    keep();
    throw Stopped(partial && !partial->kept() ? "; nothing is kept" : what_is_kept(""));
  } catch (const LevelLimit& e) {
    keep();
    throw Error(e.what() +
                what_is_kept(", also when the grid is seeded with a larger search.max_levels"));
  } catch (const Error& e) {
    keep();
    throw Error(e.what() + what_is_kept(""));
  } catch (...) {
    keep();
    throw;
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
  Rounds rounds(grid, converter, progress, partial);
  kept(
      partial, [&] { rounds.run(); }, [&] { rounds.keep(); });
  SectionHeader header = rounds.header();
  Levels& levels = rounds.levels();
  if (header.lacks_tears()) {
    const Grid finished = take_grid(header, levels);
    const std::vector<OneWayLink> links = one_way_links(finished);
    std::vector<TearByte> tears;
    kept(
        partial, [&] { tears = find_tears(finished, links, converter, progress); },
        [&] {
          if (partial) partial->keep(finished);
        });
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
