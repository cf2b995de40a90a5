#include "libcore/check/configurations.hpp"

#include <algorithm>
#include <array>
#include <unordered_set>
#include <utility>

#include "libcore/base/random.hpp"

namespace hapgrid {

namespace {

constexpr std::uint64_t kPointsInBlock = 1 << 14;
constexpr std::size_t kShards = 64;
constexpr int kPortion = 1024;

struct Hash {
  std::size_t operator()(const Configuration& c) const { return mix(c.levels + mix(c.base)); }
};

Box box_of_cells(const Box& box) {
  Box cells = box;
  for (std::uint32_t& count : cells.counts) count = std::max(1u, count - 1);
  return cells;
}

/// One level, and links that lead to levels.
bool is_simple_point(const Grid& grid, PointIndex p) {
  if (grid.levels(p) != 1) return false;
  const DirectionMask inside = grid.neighbourhood().inside(p);
  const auto links = grid.links(grid.first(p));
  for (int q = 0; q < kDirections; ++q)
    if (inside >> q & 1 &&
        links[q] >= grid.levels(static_cast<PointIndex>(p + grid.neighbourhood().offset(q))))
      return false;
  return true;
}

struct Counts {
  std::uint64_t cells = 0;
  std::uint64_t simple = 0;
  void add(const Counts& other) {
    cells += other.cells;
    simple += other.simple;
  }
};

using List = std::vector<Configuration>;
/// Candidates by the shard that they belong to.
using Outbox = std::array<List, kShards>;

class Search {
 public:
  Search(const Grid& grid, const CellMap& map, int threads, std::uint64_t limit)
      : grid_(grid), cells_(grid), map_(map), threads_(threads), limit_(limit) {}

  Configurations run() {
    const std::uint64_t points = grid_.box().points();
    const std::uint64_t block = (points + kShards - 1) / kShards;
    for_each_in_threads(kShards, threads_, [&](std::size_t s) {
      for (std::uint64_t p = s * block; p < std::min(points, (s + 1) * block); ++p)
        enter_cell(static_cast<PointIndex>(p), outboxes_[s]);
    });
    deliver();
    while (found_ <= limit_ && is_pending()) {
      for_each_in_threads(kShards, threads_, [&](std::size_t s) {
        // Not all at once: that many candidates need room until they are delivered.
        for (int i = 0; i < kPortion && !pending_[s].empty(); ++i) {
          const Configuration from = pending_[s].back();
          pending_[s].pop_back();
          switch_from(from, outboxes_[s]);
        }
      });
      deliver();
    }
    Configurations result;
    result.gave_up = found_ > limit_;
    result.listed.reserve(found_);
    for (auto& shard : known_) {
      result.listed.insert(result.listed.end(), shard.begin(), shard.end());
      shard = {};
    }
    std::sort(result.listed.begin(), result.listed.end());
    return result;
  }

 private:
  static void send(const Configuration& c, Outbox& outbox) {
    outbox[c.base % kShards].push_back(c);
  }

  /// Where play can start in a cell, and what leads into it from a simple one.
  void enter_cell(PointIndex base, Outbox& outbox) const {
    if (!map_.exists(base) || map_.is_simple(base)) return;
    List entries;  // most are the same
    Corners corners;
    for (int nearest = 0; nearest < 8; ++nearest)
      if (cells_.is_corner(nearest) && cells_.start(base, nearest, corners))
        entries.push_back(configuration_of(base, corners));
    const DirectionMask moves = map_.moves(base);
    for (int q = 0; q < kDirections; ++q) {
      if (!(moves >> q & 1)) continue;
      const auto neighbour = static_cast<PointIndex>(base + grid_.neighbourhood().offset(q));
      if (!map_.is_simple(neighbour)) continue;
      bool changed = false;
      const int towards = Direction(q).opposite().q();
      if (cells_.cross(towards, base, corners_of(grid_, cells_, {neighbour, 0}), corners, changed))
        entries.push_back(configuration_of(base, corners));
    }
    std::sort(entries.begin(), entries.end());
    entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
    for (const Configuration& c : entries) send(c, outbox);
  }

  void switch_from(const Configuration& from, Outbox& outbox) const {
    const Corners corners = corners_of(grid_, cells_, from);
    const DirectionMask moves = map_.moves(from.base);
    for (int q = 0; q < kDirections; ++q) {
      if (!(moves >> q & 1)) continue;
      const auto base = static_cast<PointIndex>(from.base + grid_.neighbourhood().offset(q));
      if (map_.is_simple(base)) continue;
      Corners reached;
      bool changed = false;
      if (cells_.cross(q, base, corners, reached, changed))
        send(configuration_of(base, reached), outbox);
    }
  }

  /// Empties the outboxes into the sets; what is new there is pending.
  void deliver() {
    for_each_in_threads(kShards, threads_, [&](std::size_t to) {
      for (Outbox& outbox : outboxes_) {
        for (const Configuration& c : outbox[to])
          if (known_[to].insert(c).second) pending_[to].push_back(c);
        outbox[to] = {};
      }
    });
    found_ = 0;
    for (const auto& shard : known_) found_ += shard.size();
  }
  bool is_pending() const {
    return std::any_of(pending_.begin(), pending_.end(),
                       [](const List& list) { return !list.empty(); });
  }

  const Grid& grid_;
  const Cells cells_;
  const CellMap& map_;
  const int threads_;
  const std::uint64_t limit_;
  std::array<std::unordered_set<Configuration, Hash>, kShards> known_;
  std::array<List, kShards> pending_;
  std::vector<Outbox> outboxes_ = std::vector<Outbox>(kShards);  // by the shard that sends
  std::uint64_t found_ = 0;
};

}  // namespace

Corners corners_of(const Grid& grid, const Cells& cells, const Configuration& configuration) {
  Corners corners;
  for (int corner = 0; corner < 8; ++corner) {
    corners.level[corner] = static_cast<Level>(configuration.levels >> (8 * corner));
    corners.record[corner] =
        grid.first(cells.point(configuration.base, corner)) + corners.level[corner];
  }
  return corners;
}

Configuration configuration_of(PointIndex base, const Corners& corners) {
  Configuration configuration{base, 0};
  for (int corner = 0; corner < 8; ++corner)
    configuration.levels |= std::uint64_t{corners.level[corner]} << (8 * corner);
  return configuration;
}

std::vector<CornerPair> corner_pairs(const Cells& cells) {
  std::vector<CornerPair> pairs;
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b)
      if (a != b && cells.is_corner(a) && cells.is_corner(b))
        pairs.push_back(
            {a, b,
             Direction::of((b & 1) - (a & 1), (b >> 1 & 1) - (a >> 1 & 1), (b >> 2) - (a >> 2))
                 .q()});
  return pairs;
}

bool is_mixed(const Grid& grid, const std::vector<CornerPair>& pairs, const Corners& corners) {
  return std::any_of(pairs.begin(), pairs.end(), [&](const CornerPair& pair) {
    const RecordIndex linked = grid.destination(corners.record[pair.a], pair.q);
    return linked != Grid::kNoRecord && linked != corners.record[pair.b];
  });
}

CellMap::CellMap(const Grid& grid, int threads)
    : box_(grid.box()), around_(box_of_cells(grid.box())), kind_(grid.box().points(), kNone) {
  const Cells cells(grid);
  const std::uint64_t points = box_.points();
  std::vector<std::uint8_t> is_simple(points);
  const std::size_t blocks = (points + kPointsInBlock - 1) / kPointsInBlock;
  for_each_in_threads(blocks, threads, [&](std::size_t b) {
    for (std::uint64_t p = b * kPointsInBlock; p < std::min(points, (b + 1) * kPointsInBlock); ++p)
      is_simple[p] = is_simple_point(grid, static_cast<PointIndex>(p));
  });
  const auto count = [&](std::uint64_t begin, std::uint64_t end) {
    Counts counts;
    for (std::uint64_t p = begin; p < end; ++p) {
      const auto base = static_cast<PointIndex>(p);
      const GridCoordinates c = box_.coordinates(base);
      if (c[0] >= cells.count(0) || c[1] >= cells.count(1) || c[2] >= cells.count(2)) continue;
      bool simple = true;
      for (int corner = 0; corner < 8; ++corner)
        simple &= is_simple[cells.point(base, corner)] != 0;
      kind_[p] = simple ? kSimple : kListed;
      ++counts.cells;
      counts.simple += simple;
    }
    return counts;
  };
  const auto counts = sum_of_blocks<Counts>(points, kPointsInBlock, threads, count);
  cells_ = counts.cells;
  simple_ = counts.simple;
}

std::uint64_t default_configuration_limit(const CellMap& map) {
  return 8 * map.cells() + (std::uint64_t{1} << 20);
}

Configurations find_configurations(const Grid& grid, const CellMap& map, int threads,
                                   std::uint64_t limit) {
  return Search(grid, map, threads, limit).run();
}

}  // namespace hapgrid
