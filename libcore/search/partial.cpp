#include "libcore/search/partial.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/shard/reader.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

namespace {

// What a shorter search has found is found again as fast as it is read.
constexpr std::chrono::seconds kLeastWork{1};
// A search works this many times as long as the last write took before the next write, so that
// writes take 3 % of its time at most.
constexpr int kWorkForWrite = 33;

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
  if (!grew_from(file, grid))
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

}  // namespace hapgrid
