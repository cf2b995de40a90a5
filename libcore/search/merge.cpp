#include "libcore/search/merge.hpp"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/search/levels.hpp"
#include "libcore/search/requests.hpp"
#include "libcore/search/tears.hpp"

namespace hapgrid {

MergeInput merge_input(std::vector<Section> sections) {
  MergeInput input;
  bool any = false;
  for (Section& section : sections) {
    if (section.header.content == Content::kRequests) {
      input.requests.push_back(std::move(section));
      continue;
    }
    if (section.header.content == Content::kTears) {
      input.tears.push_back(std::move(section));
      continue;
    }
    if (any)
      throw FormatError(
          format("{}: a second grid, beside {}", section.file->name(), input.grid.file->name()));
    any = true;
    input.grid = std::move(section);
  }
  if (!any) {
    const Section& first = (input.requests.empty() ? input.tears : input.requests).front();
    throw FormatError(format("{}: {}, but no grid to merge them into", first.file->name(),
                             to_string(first.header.content)));
  }
  for (const auto* shards : {&input.requests, &input.tears})
    for (const Section& section : *shards)
      if (section.header.generation != input.grid.header.generation)
        throw FormatError(format("{}: {} of generation {}, the grid's frontier is {}",
                                 section.file->name(), to_string(section.header.content),
                                 section.header.generation, input.grid.header.generation));
  if (!input.tears.empty() && input.grid.next_round() != Content::kTears)
    throw FormatError(format("{}: tear fractions, which the grid does not lack",
                             input.tears.front().file->name()));
  return input;
}

SectionHeader MergeInput::merged_header() const {
  SectionHeader header = grid.header;
  if (grid.frontier() > 0) ++header.generation;
  header.has_tears |= grid.next_round() == Content::kTears;
  return header;
}

namespace {

/// Counts the conversions of the frontier that no request answered.
class Completeness {
 public:
  explicit Completeness(const SectionHeader& grid) : grid_(grid), neighbourhood_(grid.spec.box) {}

  /// For records that nothing will settle any more.
  void count(const RecordRows& rows, std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      if (rows.generation[r] != grid_.generation) continue;
      asked_ += static_cast<std::uint64_t>(std::popcount(neighbourhood_.inside(rows.point[r])));
      const auto links = rows.links.subspan(r * kDirections, kDirections);
      const auto left = std::count(links.begin(), links.end(), kUnsettled);
      if (left == 0) continue;
      if (missing_ == 0) first_missing_ = describe(grid_.spec.box, rows.point[r], rows.level[r]);
      missing_ += static_cast<std::uint64_t>(left);
    }
  }

  /// @throw FormatError when there are any.
  void require() const {
    if (missing_ == 0) return;
    throw FormatError(
        format("requests are missing: {} of the {} conversions of generation {}, the first from "
               "{}; was a shard lost, or is one still to be expanded?",
               missing_, asked_, grid_.generation, first_missing_));
  }

 private:
  const SectionHeader& grid_;
  Neighbourhood neighbourhood_;
  std::uint64_t asked_ = 0;    // conversions that must be settled
  std::uint64_t missing_ = 0;  // of these, not settled
  std::string first_missing_;
};

/// The grid's chunks on their way from the old grid through Levels to the new one, block by block.
/// A block is the points of one chunk. Its records can need several chunks.
class GridBlocks {
 public:
  /// @throw FormatError when a chunk of the grid has points of several blocks.
  GridBlocks(const Section& grid, std::uint32_t block_points)
      : chunks_(grid.footer.chunks), block_points_(block_points), reader_(grid) {
    for (const ChunkInfo& chunk : chunks_)
      if (chunk.first_point / block_points != chunk.last_point / block_points)
        throw FormatError(format("{}: damaged: a chunk of points {} to {} crosses a multiple of {}",
                                 grid.file->name(), chunk.first_point, chunk.last_point,
                                 block_points));
  }

  /// Reads a block. Any block can be asked for.
  void load(std::uint64_t block, Levels& levels) {
    const auto first =
        std::partition_point(chunks_.begin(), chunks_.end(),
                             [&](const ChunkInfo& chunk) { return block_of(chunk) < block; });
    for (auto chunk = first; chunk != chunks_.end() && block_of(*chunk) == block; ++chunk) {
      reader_.read(static_cast<std::size_t>(chunk - chunks_.begin()), rows_);
      levels.append(rows_);
    }
  }

  /// Writes the blocks that lie wholly before `point` and were not written yet: nothing will touch
  /// them again. A block that nothing touched is copied as it is stored, unless it has records of
  /// the frontier, whose requests are then missing.
  void write_before(std::uint64_t point, Levels& levels, Completeness& completeness,
                    SectionWriter& out) {
    for (; (written_ + 1) * block_points_ <= point && written_ < levels.blocks(); ++written_) {
      for (std::size_t i = next_; i < chunks_.size() && block_of(chunks_[i]) == written_; ++i)
        if (chunks_[i].frontier > 0) levels.touch(written_);
      const bool touched = levels.is_loaded(written_);
      for (; next_ < chunks_.size() && block_of(chunks_[next_]) == written_; ++next_) {
        if (touched) continue;
        reader_.read_stored(next_, frame_);
        out.copy(chunks_[next_], frame_);
      }
      levels.visit(written_, [&](const RecordRows& rows, std::size_t begin, std::size_t end) {
        completeness.count(rows, begin, end);
        out.records(rows, begin, end);
      });
      levels.release(written_);
    }
  }

 private:
  std::uint64_t block_of(const ChunkInfo& chunk) const { return chunk.first_point / block_points_; }

  const std::vector<ChunkInfo>& chunks_;
  std::uint64_t block_points_;
  SectionReader reader_;
  RecordRows rows_;
  std::vector<std::byte> frame_;  // of a chunk that is copied
  std::uint64_t written_ = 0;     // blocks
  std::size_t next_ = 0;          // chunk that was not passed yet
};

[[noreturn]] void fail_unasked(const GridSpec& spec, const SourceRequests& source) {
  throw FormatError(
      format("requests: {}, direction {}: the grid's frontier asks for no such conversion",
             describe(spec.box, source.point, source.level), std::countr_zero(source.directions)));
}

/// Its chunks can be small or large ones.
void copy_chunks(const Section& grid, SectionWriter& out) {
  SectionReader reader(grid);
  std::vector<std::byte> frame;
  for (std::size_t i = 0; i < grid.footer.chunks.size(); ++i) {
    reader.read_stored(i, frame);
    out.copy(grid.footer.chunks[i], frame);
  }
}

}  // namespace

void merge(const MergeInput& input, const Model& model, SectionWriter& out, Progress& progress) {
  const SectionHeader& header = input.grid.header;
  RequestReader requests(input.requests);
  SourceRequests source;
  if (input.grid.frontier() == 0) {
    if (requests.next(source)) fail_unasked(header.spec, source);
    if (header.lacks_tears()) return merge_tears(input.grid, input.tears, out, progress);
    copy_chunks(input.grid, out);
    return out.finish();
  }
  GridBlocks blocks(input.grid, chunk_points(header.spec.row_size()));
  Levels levels(header.spec, model, [&](std::uint64_t block) { blocks.load(block, levels); });
  Completeness completeness(header);
  const auto reach = static_cast<std::uint64_t>(Neighbourhood(header.spec.box).reach());
  while (requests.next(source)) {
    if (source.point > reach) blocks.write_before(source.point - reach, levels, completeness, out);
    const Levels::RecordHandle handle = levels.find(source.point, source.level);
    if (!handle || levels.generation(handle) != header.generation)
      fail_unasked(header.spec, source);
    levels.settle(
        handle, source.directions, header.generation + 1,
        [&source](int q) { return source.row(q); }, [](const Levels::Stored&) {});
    progress.conversions += static_cast<std::uint64_t>(std::popcount(source.directions));
  }
  blocks.write_before(levels.blocks() * levels.block_points(), levels, completeness, out);
  completeness.require();
  out.finish();
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
