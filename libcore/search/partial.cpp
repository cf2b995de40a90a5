#include "libcore/search/partial.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/shard/reader.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

namespace {

constexpr double kWorkForWrite = 33;  // times as long as a write took before the next one

/// The records of a section, one by one.
class Records {
 public:
  explicit Records(const Section& section) : section_(section), reader_(section) {}

  bool next() {
    if (++row_ < rows_.size()) return true;
    row_ = 0;
    do {
      if (chunk_ == section_.footer.chunks.size()) return false;
      reader_.read(chunk_++, rows_);
    } while (rows_.size() == 0);
    return true;
  }
  std::uint32_t generation() const { return rows_.generation[row_]; }
  /// @param settled whether both have the links of this record
  bool same(const Records& other, bool settled) const {
    const auto equal = [&](const auto& a, const auto& b, std::size_t each) {
      return std::memcmp(&a[row_ * each], &b[other.row_ * each], each * sizeof a[0]) == 0;
    };
    return equal(rows_.point, other.rows_.point, 1) && equal(rows_.level, other.rows_.level, 1) &&
           generation() == other.generation() &&
           equal(rows_.numbers, other.rows_.numbers, rows_.width) &&
           (!settled || equal(rows_.links, other.rows_.links, kDirections));
  }

 private:
  const Section& section_;
  SectionReader reader_;
  RecordRows rows_;
  std::size_t chunk_ = 0;
  std::size_t row_ = 0;
};

/// Whether `later` has all records of `earlier`, and else only those of later generations.
bool grew_from(const Section& later, const Section& earlier) {
  const std::uint32_t generation = earlier.header.generation;
  Records found(later);
  Records known(earlier);
  while (found.next()) {
    if (found.generation() > generation) continue;
    if (!known.next() || !found.same(known, found.generation() < generation)) return false;
  }
  return !known.next();
}

}  // namespace

PartialGrid::PartialGrid(std::string name, double seconds,
                         std::function<void(const std::string&)> tell)
    : name_(std::move(name)),
      least_(seconds),
      tell_(std::move(tell)),
      due_(Clock::now() + std::chrono::duration_cast<Clock::duration>(least_)) {}

Section PartialGrid::start(const Section& grid) {
  known_ = grid.header.generation;
  const auto type = std::filesystem::symlink_status(name_).type();
  if (type == std::filesystem::file_type::not_found) return grid;
  const std::string remove = "; remove it to begin anew";
  // Nobody has put anything else there for a good reason: a link would have us read what it names.
  if (type != std::filesystem::file_type::regular)
    throw FormatError(name_ + ": is no regular file" + remove);
  Section file = open_grid(name_);
  GridSpec spec = file.header.spec;
  const std::uint32_t limit = std::exchange(spec.max_levels, grid.header.spec.max_levels);
  if (spec != grid.header.spec)
    throw FormatError(name_ + ": another grid than " + grid.file->name() + ": " +
                      difference(spec, grid.header.spec) + remove);
  if (limit > spec.max_levels)
    throw FormatError(name_ + ": was found with a level limit of " + std::to_string(limit) +
                      ", which is now " + std::to_string(spec.max_levels) + remove);
  if (file.header.has_tears || !grew_from(file, grid))
    throw FormatError(name_ + ": did not grow from " + grid.file->name() +
                      ", which has other seeds or is of a later generation" + remove);
  file.header.spec.max_levels = spec.max_levels;
  kept_ = known_ = file.header.generation;
  return file;
}

template <class Visit>
void PartialGrid::write(const SectionHeader& header, Visit&& visit) {
  const Clock::time_point begin = Clock::now();
  OutputFile out = OutputFile::replacing(name_);
  SectionWriter writer(out.fd(), out.name(), header);
  const Neighbourhood neighbourhood(header.spec.box);
  std::array<Level, kDirections> unsettled;
  visit([&](PointIndex point, Level level, std::uint32_t generation, const double* row,
            const Level* links) {
    if (generation > header.generation) return;
    if (generation == header.generation) {  // what the next one settled does not count
      const DirectionMask inside = neighbourhood.inside(point);
      for (int q = 0; q < kDirections; ++q)
        unsettled[static_cast<std::size_t>(q)] = inside >> q & 1 ? kUnsettled : kLeavesBox;
      links = unsettled.data();
    }
    writer.record(point, level, generation, row, links);
  });
  writer.finish();
  out.commit();
  kept_ = known_ = header.generation;
  const Clock::time_point end = Clock::now();
  const auto wait = std::max<std::chrono::duration<double>>(least_, kWorkForWrite * (end - begin));
  due_ = end + std::chrono::duration_cast<Clock::duration>(wait);
}

void PartialGrid::write(const SectionHeader& header, const Levels& levels) {
  write(header, [&](const auto& record) {
    for (std::uint64_t b = 0; b < levels.blocks(); ++b)
      levels.visit(b, [&](const RecordRows& rows, std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r)
          record(rows.point[r], rows.level[r], rows.generation[r], &rows.numbers[r * rows.width],
                 &rows.links[r * kDirections]);
      });
  });
}

void PartialGrid::keep_if_due(const SectionHeader& header, const Levels& levels) {
  if (header.generation <= known_ || Clock::now() < due_) return;
  const bool first = !kept_;
  try {
    write(header, levels);
  } catch (const std::exception& e) {
    due_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(least_);
    if (!std::exchange(complained_, true))
      tell_(std::string("cannot keep what is found: ") + e.what());
    return;
  }
  if (first)
    tell_(name_ + " keeps generation " + std::to_string(header.generation) +
          " and later ones: after an interruption the same command goes on from it");
}

void PartialGrid::keep(const SectionHeader& header, const Levels& levels) noexcept {
  try {
    if (header.generation > known_) write(header, levels);
  } catch (...) {  // the error that it is for is the one to tell of
  }
}

void PartialGrid::keep(const Grid& grid) noexcept {
  try {
    if (grid.generation() <= known_) return;
    write({Content::kGrid, grid.generation(), grid.spec()}, [&](const auto& record) {
      for (RecordIndex r = 0; r < grid.records(); ++r)
        record(grid.point(r), grid.level(r), grid.record_generation(r), grid.row(r).data(),
               grid.links(r).data());
    });
  } catch (...) {
  }
}

void PartialGrid::remove() {
  if (kept_) std::filesystem::remove(name_);
}

}  // namespace hapgrid
