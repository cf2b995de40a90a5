#include "libcore/search/tears.hpp"

#include <algorithm>
#include <bit>
#include <deque>
#include <string>
#include <string_view>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/search/bisection.hpp"
#include "libcore/shard/load.hpp"
#include "libcore/shard/reader.hpp"

namespace hapgrid {

namespace {

/// What one thread does: as many bisections side by side as its model takes questions at a time.
void bisect(const Grid& grid, std::span<const OneWayLink> links, WorkQueue& queue, Model& model,
            Progress& progress, std::vector<TearByte>& tears) {
  StateDistance distance(grid.spec(),
                         [&](const double* a, const double* b) { return model.equal(a, b); });
  std::deque<Bisection> bisections;  // a conversion's tag is the number of one
  std::vector<std::size_t> ready;    // those that have a conversion to be made
  std::vector<std::size_t> free;
  WorkQueue::Slice mine;
  CurrentConversion& current = current_conversion();
  model.convert_all(
      [&](Conversion& conversion, bool idle) {
        if (ready.empty()) {
          std::uint64_t index = 0;
          if (!queue.next(mine, idle, index)) return false;
          if (free.empty()) {
            free.push_back(bisections.size());
            bisections.emplace_back(grid.spec().row_size());
          }
          ready.push_back(free.back());
          free.pop_back();
          const OneWayLink link = links[index];
          bisections[ready.back()].start(index, grid.box().position(grid.point(link.record)),
                                         grid.neighbourhood().shift(link.q), grid.row(link.record),
                                         grid.row(grid.destination(link.record, link.q)));
        }
        const std::size_t number = ready.back();
        ready.pop_back();
        conversion = bisections[number].conversion(number);
        const OneWayLink link = links[bisections[number].index()];
        if (!model.is_process())
          current = {grid.point(link.record), grid.level(link.record), link.q};
        return true;
      },
      [&](const Conversion& conversion, std::string_view error) {
        Bisection& bisection = bisections[conversion.tag];
        progress.tear_conversions.fetch_add(1, std::memory_order_relaxed);
        if (error.empty() && !bisection.advance(distance)) return ready.push_back(conversion.tag);
        free.push_back(conversion.tag);
        if (!error.empty()) return queue.fail(bisection.index(), error);
        tears[bisection.index()] = bisection.tear();
        progress.links_done.fetch_add(1, std::memory_order_relaxed);
      });
  current.q = -1;
}

/// The tear bytes of the grid's records, R x 26, all kNoTear.
std::vector<TearByte> no_tears(const Grid& grid) {
  return std::vector<TearByte>(std::size_t{grid.records()} * kDirections, kNoTear);
}

/// Where the tear byte of a link is among those of the grid.
std::size_t index_of(RecordIndex r, int q) {
  return std::size_t{r} * kDirections + static_cast<unsigned>(q);
}

void write_grid(const Grid& grid, const std::vector<TearByte>& tears, SectionWriter& out) {
  for (RecordIndex r = 0; r < grid.records(); ++r)
    out.record(grid.point(r), grid.level(r), grid.record_generation(r), grid.row(r).data(),
               grid.links(r).data(), &tears[index_of(r, 0)]);
  out.finish();
}

/// Puts the tear fractions of a chunk among those of the grid.
void add_tears(const Grid& grid, const TearRows& rows, std::vector<TearByte>& tears) {
  const auto fail = [&](std::size_t r, int q, const char* what) {
    throw FormatError(format("tear fractions: {}, direction {}: {}",
                             describe(grid.box(), rows.point[r], rows.level[r]), q, what));
  };
  const TearByte* tear = rows.tears.data();
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (DirectionMask left = rows.directions[r]; left; left &= left - 1, ++tear) {
      const int q = std::countr_zero(left);
      const RecordIndex record = grid.first(rows.point[r]) + rows.level[r];
      if (rows.level[r] >= grid.levels(rows.point[r]) || !grid.is_one_way(record, q))
        fail(r, q, "the grid has no such one-way link");
      TearByte& known = tears[index_of(record, q)];
      if (known != kNoTear && known != *tear) fail(r, q, "two different answers");
      known = *tear;
    }
}

}  // namespace

std::vector<OneWayLink> one_way_links(const Grid& grid, Part part) {
  std::vector<OneWayLink> links;
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (int q = 0; q < kDirections; ++q)
      if (grid.is_one_way(r, q)) links.push_back({r, static_cast<std::uint8_t>(q)});
  if (part.of == 1) return links;
  const Partition partition(links.size(), part);
  std::vector<OneWayLink> mine;
  for (std::size_t i = 0; i < links.size(); ++i)
    if (partition.has_any(i, i + 1)) mine.push_back(links[i]);
  return mine;
}

std::vector<TearByte> find_tears(const Grid& grid, std::span<const OneWayLink> links,
                                 Converter& converter, Progress& progress) {
  progress.links = links.size();
  std::vector<TearByte> tears(links.size());
  WorkQueue queue(links.size(), converter.models(), 1, progress);
  converter.run(queue, [&](Model& model) { bisect(grid, links, queue, model, progress, tears); });
  queue.require_success([&](std::uint64_t i) {
    return "tear fraction of " + describe_link(grid, links[i].record, links[i].q);
  });
  return tears;
}

void write_tears(const Grid& grid, std::span<const OneWayLink> links,
                 std::span<const TearByte> tears, SectionWriter& out) {
  for (std::size_t begin = 0, end = 0; begin < links.size(); begin = end) {
    const RecordIndex r = links[begin].record;
    DirectionMask directions = 0;
    for (; end < links.size() && links[end].record == r; ++end)
      directions |= DirectionMask{1} << links[end].q;
    out.tears(grid.point(r), grid.level(r), directions, &tears[begin]);
  }
  out.finish();
}

void write_torn_grid(const Grid& grid, std::span<const OneWayLink> links,
                     std::span<const TearByte> tears, SectionWriter& out) {
  std::vector<TearByte> all = no_tears(grid);
  for (std::size_t i = 0; i < links.size(); ++i)
    all[index_of(links[i].record, links[i].q)] = tears[i];
  write_grid(grid, all, out);
}

void merge_tears(const Section& section, std::span<const Section> shards, SectionWriter& out,
                 Progress& progress) {
  const Grid grid = load_grid(section).grid;
  std::vector<TearByte> tears = no_tears(grid);
  TearRows rows;
  for (const Section& shard : shards) {
    SectionReader reader(shard);
    for (std::size_t i = 0; i < shard.footer.chunks.size(); ++i) {
      reader.read(i, rows);
      add_tears(grid, rows, tears);
      progress.conversions += rows.tears.size();
    }
  }
  const std::vector<OneWayLink> links = one_way_links(grid);
  const auto is_missing = [&](OneWayLink link) {
    return tears[index_of(link.record, link.q)] == kNoTear;
  };
  if (const auto missing = std::count_if(links.begin(), links.end(), is_missing); missing > 0) {
    const OneWayLink first = *std::find_if(links.begin(), links.end(), is_missing);
    throw FormatError(
        format("tear fractions are missing: {} of the {} one-way links, the first of {}; was a "
               "shard lost, or is one still to be expanded?",
               missing, links.size(), describe_link(grid, first.record, first.q)));
  }
  write_grid(grid, tears, out);
}

}  // namespace hapgrid
