#include "libcore/search/merge.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <optional>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/search/levels.hpp"
#include "libcore/shard/merged_rows.hpp"

namespace hapgrid {

MergeInput::MergeInput(const std::vector<Section>& sections) {
  for (const Section& section : sections) {
    if (section.header.content == Content::kFrontier)
      throw FormatError(section.file->name() +
                        ": holds a part of a frontier; merge takes a grid and requests");
    (section.header.content == Content::kGrid ? grid_ : requests_).push_back(section);
  }
  if (grid_.empty())
    throw FormatError(sections.front().file->name() + ": requests, but no grid to merge them into");
  require_content(grid_, Content::kGrid);
  generation_ = generation_of(grid_);
  require_lossless(grid_);
  for (const Section& section : requests_)
    if (section.header.generation != generation())
      throw FormatError(section.file->name() + ": requests of generation " +
                        std::to_string(section.header.generation) + ", the grid's frontier is " +
                        std::to_string(generation()));
  for (const Section& section : grid_) conversions_ += section.footer.conversions;
}

SectionHeader MergeInput::merged_header() const {
  SectionHeader header = grid_.front().header;
  header.generation = generation_ + (conversions_ > 0 ? 1 : 0);
  header.coding = {};
  return header;
}

namespace {

class Merge {
 public:
  Merge(const MergeInput& input, PointRange range, const Model& model, SectionWriter& out,
        SectionWriter* frontier, Progress& progress)
      : input_(input),
        range_(range),
        reach_(static_cast<std::uint64_t>(Neighbourhood(input.spec().box).reach())),
        targets_(range.widened(reach_)),
        sources_(needed_points(input.spec(), range)),
        levels_(input.spec(), model),
        grid_rows_(input.grid()),
        out_(out),
        frontier_(frontier),
        progress_(progress) {
    const std::vector<Section>& grid = input.grid();
    const bool plain = std::none_of(grid.begin(), grid.end(), [](const Section& section) {
      return section.header.coding.is_coded;
    });
    // Of the youngest generation: it takes the chunks of all.
    for (const Section& section : grid)
      if (plain && !opener_ && section.header.generation == input.generation())
        opener_.emplace(section);
  }

  NewRecords run() {
    const std::uint32_t generation = input_.merged_header().generation;
    MergedRows<RequestRows> requests(input_.requests());
    for (Run<RequestRows> run = requests.next(); run.rows; run = requests.next()) {
      const RequestRows& rows = *run.rows;
      for (std::size_t r = run.begin; r < run.end; ++r) {
        const PointIndex target = rows.target[r];
        if (!targets_.holds(target)) continue;
        if (target != prepared_) {
          // A source lies at most `reach` behind its target, and is touched at most `reach` later.
          advance(target + reach_, target > reach_ ? target - reach_ : 0);
          open_block(target / levels_.block_points());
          prepared_ = target;
        }
        levels_.settle(target, rows.direction[r], rows.level[r], rows.row(r), generation);
      }
      progress_.conversions += run.end - run.begin;
    }
    const std::uint64_t end = levels_.blocks() * levels_.block_points();
    advance(end, end);
    if (missing_ > 0)
      throw FormatError("requests are missing: " + std::to_string(missing_) + " of the " +
                        std::to_string(asked_) + " conversions of generation " +
                        std::to_string(input_.generation()) + ", the first from " + first_missing_ +
                        "; was a shard lost, or is one still to be expanded?");
    return stored_;
  }

 private:
  /// Reads the grid's records up to the point `wanted`, and writes the blocks that lie wholly
  /// before the point `settled`: nothing will touch them again.
  void advance(std::uint64_t wanted, std::uint64_t settled) {
    while (loaded_ <= wanted) {
      if (!run_.rows || run_.begin == run_.end) {
        if (hold(settled)) continue;
        run_ = grid_rows_.next();
        if (!run_.rows) {
          loaded_ = ~std::uint64_t{0};
          break;
        }
        emit_before(std::min<std::uint64_t>(settled, run_.rows->point[run_.begin]));
      }
      const RecordRows& rows = *run_.rows;
      if (sources_.holds(rows.point[run_.begin]))
        open_block(rows.point[run_.begin] / levels_.block_points());
      const std::size_t r = first_at(rows, run_.begin, run_.end, wanted + 1);
      append(rows, run_.begin, r);
      run_.begin = r;
      loaded_ = r < run_.end ? rows.point[r] : rows.point[r - 1];
    }
    emit_before(settled);
  }

  /// The first of rows [begin, end) that is at `point` or behind it.
  static std::size_t first_at(const RecordRows& rows, std::size_t begin, std::size_t end,
                              std::uint64_t point) {
    const auto at = [&](std::size_t r) {
      return rows.point.begin() + static_cast<std::ptrdiff_t>(r);
    };
    return static_cast<std::size_t>(std::lower_bound(at(begin), at(end), point) - at(0));
  }

  void append(const RecordRows& rows, std::size_t begin, std::size_t end) {
    begin = first_at(rows, begin, end, sources_.begin);
    levels_.append(rows, begin, first_at(rows, begin, end, sources_.end));
  }

  /// Keeps the next chunk as it is stored, if it is without frontier: where no request comes for
  /// its points, it is copied, and neither decoded nor compressed again. Answers whether it did.
  bool hold(std::uint64_t settled) {
    if (!opener_) return false;
    SectionReader* section = grid_rows_.whole_chunk_next();
    if (!section) return false;
    const ChunkInfo& next = *section->peek();
    const std::uint64_t block = next.first_point / levels_.block_points();
    if (next.last_point < sources_.begin || next.first_point >= sources_.end) {
      loaded_ = next.last_point;
      section->next_stored(passed_over_);
      return true;
    }
    if (next.frontier > 0 || next.last_point / levels_.block_points() != block ||
        block >= levels_.blocks() || levels_.holds(block) ||
        grid_rows_.next_section_point() / levels_.block_points() <= block)
      return false;
    // Blocks before the next record are read in full.
    emit_before(std::min<std::uint64_t>(settled, next.first_point));
    loaded_ = next.last_point;
    StoredChunk chunk;
    if (!spare_.empty()) {
      chunk = std::move(spare_.back());
      spare_.pop_back();
    }
    section->next_stored(chunk);
    held_[block].push_back(std::move(chunk));
    return true;
  }

  /// Decodes the chunks that are held for a block: the block changes.
  void open_block(std::uint64_t block) {
    if (held_.empty()) return;
    const auto held = held_.find(block);
    if (held == held_.end()) return;
    for (StoredChunk& chunk : held->second) {
      opener_->decode(chunk, opened_);
      append(opened_, 0, opened_.size());
      spare_.push_back(std::move(chunk));
    }
    held_.erase(held);
  }

  /// Writes the blocks that lie wholly before `point`.
  void emit_before(std::uint64_t point) {
    while ((emitted_ + 1) * levels_.block_points() <= point) {
      if (!range_.holds(emitted_ * levels_.block_points())) {
        held_.erase(emitted_);
        levels_.visit(emitted_, [this](const RecordRows& rows, std::size_t begin, std::size_t end) {
          for (std::size_t r = begin; r < end; ++r) check_settled(rows, r);
        });
        levels_.release(emitted_);
      } else if (const auto held = held_.find(emitted_); held != held_.end()) {
        for (StoredChunk& chunk : held->second) {
          out_.copy(chunk);
          spare_.push_back(std::move(chunk));
        }
        held_.erase(held);
      } else {
        levels_.visit(emitted_, [this](const RecordRows& rows, std::size_t begin, std::size_t end) {
          emit(rows, begin, end);
        });
        levels_.release(emitted_);
      }
      ++emitted_;
    }
  }

  void emit(const RecordRows& rows, std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      check_settled(rows, r);
      if (rows.generation[r] <= input_.generation()) continue;
      const DirectionMask todo = unsettled(&rows.links[r * kDirections]);
      stored_.points += rows.level[r] == 0;
      ++stored_.records;
      stored_.conversions += static_cast<std::uint64_t>(std::popcount(todo));
      if (frontier_) frontier_->frontier(rows.point[r], rows.level[r], rows.row(r), todo);
    }
    out_.records(rows, begin, end);
  }

  /// Counts what is missing. Also around the range: a request that is missing there would give
  /// another number to a level that one of the range's links leads to.
  void check_settled(const RecordRows& rows, std::size_t r) {
    if (rows.generation[r] != input_.generation()) return;
    const PointIndex point = rows.point[r];
    const DirectionMask inside = inside_.inside(point);
    DirectionMask beyond = 0;  // in the box, but of no range that is looked at
    if (point < targets_.begin + reach_ || point + reach_ >= targets_.end) {
      for (int q = 0; q < kDirections; ++q)
        if (!targets_.holds(static_cast<std::uint64_t>(point + inside_.offset(q))))
          beyond |= DirectionMask{1} << q & inside;
    }
    asked_ += static_cast<std::uint64_t>(std::popcount(inside & ~beyond));
    // A link out of the box that is not settled never will be.
    const DirectionMask left = unsettled(&rows.links[r * kDirections]) & ~beyond;
    if (!left) return;
    if (missing_ == 0) first_missing_ = describe(input_.spec().box, point, rows.level[r]);
    missing_ += static_cast<std::uint64_t>(std::popcount(left));
  }

  const MergeInput& input_;
  PointRange range_;  // of the records that are wanted
  std::uint64_t reach_;
  PointRange targets_;  // of the requests, and
  PointRange sources_;  // of the records, that these depend on
  Neighbourhood inside_{input_.spec().box};
  Levels levels_;
  MergedRows<RecordRows> grid_rows_;
  Run<RecordRows> run_;
  SectionWriter& out_;
  SectionWriter* frontier_;
  Progress& progress_;
  std::optional<SectionReader> opener_;  // decodes chunks; only where the grid is plain
  std::map<std::uint64_t, std::vector<StoredChunk>> held_;  // by block
  std::vector<StoredChunk> spare_;
  StoredChunk passed_over_;
  RecordRows opened_;
  std::uint64_t prepared_ = ~std::uint64_t{0};  // target whose surroundings are in levels_
  std::uint64_t loaded_ = 0;                    // the next record's point is at least this
  std::uint64_t emitted_ = 0;                   // blocks below are written
  NewRecords stored_;                           // of the range
  std::uint64_t asked_ = 0;                     // conversions that must be settled
  std::uint64_t missing_ = 0;                   // of these, not settled
  std::string first_missing_;
};

}  // namespace

NewRecords merge(const MergeInput& input, PointRange range, const Model& model, SectionWriter& out,
                 SectionWriter* frontier, Progress& progress) {
  const NewRecords stored = Merge(input, range, model, out, frontier, progress).run();
  out.finish();
  if (frontier) frontier->finish();
  return stored;
}

}  // namespace hapgrid
