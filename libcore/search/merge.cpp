#include "libcore/search/merge.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/search/levels.hpp"
#include "libcore/shard/merged_rows.hpp"
#include "libcore/shard/record_stream.hpp"

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

void MergeInput::require_layers() const {
  for (const Section& section : grid_)
    if (section.footer.frontier > 0 && section.footer.frontier < section.footer.records)
      throw FormatError(section.file->name() +
                        ": the frontier is in one shard with other records; --layer takes a grid "
                        "whose frontier is apart (merge --tip)");
}

SectionHeader MergeInput::merged_header() const {
  SectionHeader header = grid_.front().header;
  header.generation = generation_ + (conversions_ > 0 ? 1 : 0);
  header.coding = {};
  return header;
}

namespace {

/// Which records are needed. Those of the frontier, all of them. Of the others, where a grid is in
/// layers, few:
///
/// Let a conversion lead from a record of generation G at the point s to the point t. Had t a
/// record of a generation before G - 1, then that one's own conversion back to s would have stored
/// a record at s, or found one, of a generation before G. So if the source has level 0, it is the
/// first at its point, and all that is known at t is of generation G - 1 or G. Sections that end
/// before that are read only around sources with a higher level, and where such a level itself
/// needs the lower ones of its point.
class Merge {
 public:
  Merge(const MergeInput& input, PointRange range, const Model& model, const MergeOutput& out,
        Progress& progress)
      : input_(input),
        range_(range),
        neighbourhood_(input.spec().box),
        reach_(static_cast<std::uint64_t>(neighbourhood_.reach())),
        targets_(range.widened(reach_)),
        sources_(needed_points(input.spec(), range)),
        levels_(input.spec(), model),
        out_(out),
        progress_(progress),
        block_bits_(static_cast<unsigned>(std::countr_zero(levels_.block_points()))),
        touched_(levels_.blocks()) {
    std::vector<const Section*> sections;
    for (const Section& section : input.grid()) sections.push_back(&section);
    // By age: so a point's levels come in their order.
    const auto age = [](const Section* section) {
      return std::pair(section->header.generation, section->footer.frontier > 0);
    };
    std::stable_sort(sections.begin(), sections.end(),
                     [&](const Section* a, const Section* b) { return age(a) < age(b); });
    for (const Section* section : sections) {
      const bool has_frontier = section->footer.frontier > 0;
      const bool recent = section->header.generation == input.generation();
      streams_.push_back({RecordStream(*section), has_frontier ? kTip : recent ? kRecent : kOld});
    }
  }

  NewRecords run() {
    MergedRows<RequestRows> requests(input_.requests());
    for (Run<RequestRows> run = requests.next(); run.rows; run = requests.next()) {
      for (std::size_t r = run.begin; r < run.end; ++r)
        if (sources_.holds(run.rows->point[r])) settle(*run.rows, r, r + 1 == run.end);
    }
    const std::uint64_t end = first_of(levels_.blocks());
    advance(end - 1, end);
    for (Stream& stream : streams_)
      if (stream.age != kOld || !out_.layer) stream.records.finish();
    if (missing_ > 0)
      throw FormatError("requests are missing: " + std::to_string(missing_) + " of the " +
                        std::to_string(asked_) + " conversions of generation " +
                        std::to_string(input_.generation()) + ", the first from " + first_missing_ +
                        "; was a shard lost, or is one still to be expanded?");
    return stored_;
  }

 private:
  /// Takes the requests of a source record. @param may_go_on whether the next row can be of the
  /// same record: its other requests may come from another shard, and some of these again.
  void settle(const RequestRows& rows, std::size_t r, bool may_go_on) {
    const PointIndex point = rows.point[r];
    const RowKey key = record_key(point, rows.level[r]);
    if (key != source_key_) {
      if (point + reach_ >= first_of(loaded_))
        advance(point + reach_, point > reach_ ? point - reach_ : 0);
      source_ = levels_.find(point, rows.level[r]);
      if (!source_ || levels_.generation(source_) != input_.generation())
        fail(rows, r, std::countr_zero(rows.directions[r]),
             "the grid's frontier asks for no such conversion");
      source_key_ = key;
      answered_ = 0;
    }
    const DirectionMask directions = rows.directions[r];
    const double* const first = rows.row(rows.first[r]);
    const auto row = [&](int q) {
      const bool all = directions == kAllDirections;
      return first + rows.width * static_cast<unsigned>(all ? q : rank(directions, q));
    };
    if (directions & answered_) require_same(rows, r, row);
    const DirectionMask wanted = directions & ~answered_ & ~beyond_targets(point);
    levels_.settle(source_, wanted, input_.generation() + 1, row, [](const Levels::Stored&) {});
    if (may_go_on) {
      for (DirectionMask left = directions; left; left &= left - 1) {
        const int q = std::countr_zero(left);
        std::copy_n(row(q), rows.width, &answers_[static_cast<unsigned>(q) * rows.width]);
      }
    }
    answered_ |= directions;
    progress_.conversions += static_cast<std::uint64_t>(std::popcount(directions));
  }

  /// How many of the directions come before direction q.
  static int rank(DirectionMask directions, int q) {
    return std::popcount(directions & ((DirectionMask{1} << q) - 1));
  }

  /// What was answered before must be answered again, bit by bit.
  template <class Row>
  void require_same(const RequestRows& rows, std::size_t r, Row&& row) const {
    for (DirectionMask left = rows.directions[r] & answered_; left; left &= left - 1) {
      const int q = std::countr_zero(left);
      const double* const answer = &answers_[static_cast<unsigned>(q) * rows.width];
      if (std::memcmp(row(q), answer, rows.width * sizeof(double)) != 0)
        fail(rows, r, q, "two different answers");
    }
  }

  /// The directions that lead to points of no range that is looked at; those that leave the box may
  /// be among them.
  DirectionMask beyond_targets(PointIndex point) const {
    if (point >= targets_.begin + reach_ && point + reach_ < targets_.end) return 0;
    DirectionMask beyond = 0;
    for (int q = 0; q < kDirections; ++q)
      if (!targets_.holds(static_cast<std::uint64_t>(point + neighbourhood_.offset(q))))
        beyond |= DirectionMask{1} << q;
    return beyond;
  }

  [[noreturn]] void fail(const RequestRows& rows, std::size_t r, int q, const char* what) const {
    throw FormatError("requests: " + describe(input_.spec().box, rows.point[r], rows.level[r]) +
                      ", direction " + std::to_string(q) + ": " + what);
  }

  enum Age { kOld, kRecent, kTip };
  struct Stream {
    RecordStream records;
    Age age;
  };
  /// What is known of a block, as bits: which levels conversions come from that lead there, and
  /// whether recent records have lower levels at their point.
  enum Touched : std::uint8_t { kFromFirst = 1, kFromHigher = 2, kReached = 3, kHigherRecent = 4 };

  std::uint64_t first_of(std::uint64_t block) const { return block * levels_.block_points(); }

  /// Reads the blocks up to the point `wanted`, and writes those that lie wholly before the point
  /// `settled`: nothing will touch them again.
  void advance(std::uint64_t wanted, std::uint64_t settled) {
    for (; loaded_ < levels_.blocks() && first_of(loaded_) <= wanted; ++loaded_) {
      emit_before(std::min(settled, first_of(loaded_)));
      load(loaded_);
    }
    emit_before(settled);
  }

  /// Reads what is needed of a block.
  void load(std::uint64_t block) {
    const std::uint64_t begin = std::max(first_of(block), sources_.begin);
    const std::uint64_t end = std::min(first_of(block + 1), sources_.end);
    if (begin >= end) return;
    for (Stream& stream : streams_)
      if (is_followed(stream)) stream.records.skip_before(begin);
    look_at_frontier(first_of(block + 1) + reach_);
    if (!(touched_[block] & kReached) && (out_.layer || keep_stored(block, end))) return;
    if (out_.layer) look_at_recent(end);
    const bool all = !out_.layer || (touched_[block] & ~kFromFirst);
    for (Stream& stream : streams_) {
      if (!is_followed(stream)) {
        if (!all) continue;
        stream.records.skip_before(begin);
      }
      for (auto run = stream.records.next_before(end); run.rows;
           run = stream.records.next_before(end))
        levels_.append(*run.rows, run.begin, run.end, /*passive=*/!is_followed(stream));
    }
  }

  /// Whether each block is looked for in it.
  bool is_followed(const Stream& stream) const { return stream.age != kOld || !out_.layer; }

  /// Marks the blocks that the frontier's conversions lead to from before the point `end`, and
  /// those of the frontier itself.
  void look_at_frontier(std::uint64_t end) {
    for (Stream& stream : streams_) {
      if (stream.age != kTip) continue;
      stream.records.look_ahead(
          end, [](const ChunkInfo& chunk) { return chunk.frontier > 0; },
          [this](const RecordRows& rows) {
            for (std::size_t r = 0; r < rows.size(); ++r)
              if (rows.generation[r] == input_.generation())
                touch(rows.point[r], rows.level[r] == 0 ? kFromFirst : kFromHigher);
          });
    }
  }

  void touch(std::uint64_t point, Touched how) {
    const auto count = [&](int axis) {
      return std::uint64_t{input_.spec().box.counts[static_cast<std::size_t>(axis)]};
    };
    const std::uint64_t last = levels_.blocks() - 1;
    const std::uint64_t row = count(0) + 1;  // the farthest within a slice
    const std::uint64_t slice = count(0) * count(1);
    for (const std::uint64_t centre : {point - std::min(point, slice), point, point + slice}) {
      const std::uint64_t high = std::min((centre + row) >> block_bits_, last);
      for (std::uint64_t b = (centre - std::min(centre, row)) >> block_bits_; b <= high; ++b)
        touched_[b] |= how;
    }
  }

  void look_at_recent(std::uint64_t end) {
    for (Stream& stream : streams_) {
      if (stream.age != kRecent) continue;
      stream.records.look_ahead(
          end, [](const ChunkInfo&) { return true; },
          [this](const RecordRows& rows) {
            for (std::size_t r = 0; r < rows.size(); ++r)
              if (rows.level[r] > 0) touched_[rows.point[r] >> block_bits_] |= kHigherRecent;
          });
    }
  }

  /// Keeps a block that nothing touches as it is stored, where one section alone has it: it is
  /// copied, and neither decoded nor compressed again. Answers whether there is nothing else.
  bool keep_stored(std::uint64_t block, std::uint64_t end) {
    if (!range_.holds(first_of(block))) return true;
    RecordStream* only = nullptr;
    for (Stream& stream : streams_) {
      if (stream.records.next_point() >= end) continue;
      if (only) return false;
      only = &stream.records;
    }
    if (!only) return true;
    if (!only->is_stored_before(end)) return false;
    std::vector<StoredChunk>& chunks = held_[block];
    while (only->next_point() < end) {
      StoredChunk chunk;
      if (!spare_.empty()) {
        chunk = std::move(spare_.back());
        spare_.pop_back();
      }
      only->take_stored(chunk);
      chunks.push_back(std::move(chunk));
    }
    return true;
  }

  /// Writes the blocks that lie wholly before `point`.
  void emit_before(std::uint64_t point) {
    for (; first_of(emitted_ + 1) <= point; ++emitted_) {
      if (const auto held = held_.find(emitted_); held != held_.end()) {
        for (StoredChunk& chunk : held->second) {
          out_.grid.copy(chunk);
          spare_.push_back(std::move(chunk));
        }
        held_.erase(held);
        continue;
      }
      const bool wanted = range_.holds(first_of(emitted_));
      levels_.visit(emitted_, [&](const RecordRows& rows, std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r) check_settled(rows, r);
        if (wanted) emit(rows, begin, end);
      });
      levels_.release(emitted_);
    }
  }

  void emit(const RecordRows& rows, std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      if (rows.generation[r] <= input_.generation()) continue;
      const DirectionMask todo = unsettled(&rows.links[r * kDirections]);
      stored_.points += rows.level[r] == 0;
      ++stored_.records;
      stored_.conversions += static_cast<std::uint64_t>(std::popcount(todo));
      if (out_.frontier) out_.frontier->frontier(rows.point[r], rows.level[r], rows.row(r), todo);
    }
    while (begin < end) {
      SectionWriter* const to = section_of(rows.generation[begin]);
      std::size_t next = begin + 1;
      while (next < end && section_of(rows.generation[next]) == to) ++next;
      if (to) to->records(rows, begin, next);
      begin = next;
    }
  }

  SectionWriter* section_of(std::uint32_t generation) const {
    if (!out_.tip) return &out_.grid;
    if (generation > input_.generation()) return out_.tip;
    return !out_.layer || generation == input_.generation() ? &out_.grid : nullptr;
  }

  /// Counts what is missing. Also around the range: a request that is missing there would give
  /// another number to a level that one of the range's links leads to.
  void check_settled(const RecordRows& rows, std::size_t r) {
    if (rows.generation[r] != input_.generation()) return;
    const PointIndex point = rows.point[r];
    const DirectionMask inside = neighbourhood_.inside(point);
    const DirectionMask beyond = beyond_targets(point) & inside;
    asked_ += static_cast<std::uint64_t>(std::popcount(inside & ~beyond));
    // A link out of the box that is not settled never will be.
    const DirectionMask left = unsettled(&rows.links[r * kDirections]) & ~beyond;
    if (!left) return;
    if (missing_ == 0) first_missing_ = describe(input_.spec().box, point, rows.level[r]);
    missing_ += static_cast<std::uint64_t>(std::popcount(left));
  }

  const MergeInput& input_;
  PointRange range_;  // of the records that are wanted
  Neighbourhood neighbourhood_;
  std::uint64_t reach_;
  PointRange targets_;  // of the requests, and
  PointRange sources_;  // of the records, that these depend on
  Levels levels_;
  const MergeOutput& out_;
  Progress& progress_;
  std::vector<Stream> streams_;
  unsigned block_bits_;
  std::vector<std::uint8_t> touched_;                       // by block: Touched
  std::map<std::uint64_t, std::vector<StoredChunk>> held_;  // by block
  std::vector<StoredChunk> spare_;
  RowKey source_key_ = ~RowKey{0};  // of the requests taken last
  Levels::Place source_;
  DirectionMask answered_ = 0;
  std::vector<double> answers_ =  // 26 rows, where others may follow
      std::vector<double>(kDirections * std::size_t{input_.spec().row_size()});
  std::uint64_t loaded_ = 0;   // blocks below are read
  std::uint64_t emitted_ = 0;  // blocks below are written
  NewRecords stored_;          // of the range
  std::uint64_t asked_ = 0;    // conversions that must be settled
  std::uint64_t missing_ = 0;  // of these, not settled
  std::string first_missing_;
};

}  // namespace

NewRecords merge(const MergeInput& input, PointRange range, const Model& model,
                 const MergeOutput& out, Progress& progress) {
  const NewRecords stored = Merge(input, range, model, out, progress).run();
  out.grid.finish();
  if (out.tip) out.tip->finish();
  if (out.frontier) out.frontier->finish();
  return stored;
}

}  // namespace hapgrid
