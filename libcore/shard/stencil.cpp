#include "libcore/shard/stencil.hpp"

#include <algorithm>

namespace hapgrid {

namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

}  // namespace

void Stencil::find(std::span<const PointIndex> point, std::span<const Level> level,
                   std::span<const Level> links, const GridCoordinates& counts) {
  const std::size_t rows = point.size();
  fallback.resize(rows);
  for (BackwardAxis& axis : axes) {
    axis.back.resize(rows);
    axis.depth.resize(rows);
  }
  farthest = {};
  if (rows == 0) return;
  const PointIndex begin = point.front();
  first_.assign(std::size_t{point.back() - begin} + 2, kNone);
  for (std::size_t r = rows; r-- > 0;) first_[point[r] - begin] = static_cast<std::uint32_t>(r);
  const std::uint64_t strides[3] = {1, counts[0], std::uint64_t{counts[0]} * counts[1]};
  constexpr int kBack[3] = {Direction::of(-1, 0, 0).q(), Direction::of(0, -1, 0).q(),
                            Direction::of(0, 0, -1).q()};
  const auto neighbour = [&](std::size_t r, int a) {
    const PointIndex p = point[r] - begin;
    const Level l = links[r * kDirections + static_cast<std::size_t>(kBack[a])];
    if (l >= kUnsettled || p < strides[a]) return kNone;
    const std::uint32_t first = first_[p - strides[a]];
    // A chunk may begin in the middle of a point's levels.
    if (first == kNone || l < level[first]) return kNone;
    const std::uint64_t found = std::uint64_t{first} + l - level[first];
    const bool is_it = found < r && point[found] == point[r] - strides[a] && level[found] == l;
    return is_it ? static_cast<std::uint32_t>(found) : kNone;
  };
  for (std::size_t r = 0; r < rows; ++r) {
    fallback[r] = static_cast<std::uint32_t>(r == 0 ? 0 : r - 1);
    for (int a = 2; a >= 0; --a) {
      BackwardAxis& axis = axes[static_cast<std::size_t>(a)];
      const std::uint32_t found = neighbour(r, a);
      if (found != kNone) {
        fallback[r] = found;  // the last, along i, is the nearest in memory
        std::uint32_t& far = farthest[static_cast<std::size_t>(a)];
        far = std::max(far, static_cast<std::uint32_t>(r) - found);
      }
      bool same_kind = found != kNone;
      for (std::size_t b = static_cast<std::size_t>(a) + 1; same_kind && b < 3; ++b)
        same_kind = axes[b].depth[found] == axes[b].depth[r];
      axis.back[r] = same_kind ? found : 0;
      axis.depth[r] =
          same_kind ? std::min<std::uint8_t>(BackwardAxis::kMaxDepth, axis.depth[found] + 1) : 0;
    }
  }
}

}  // namespace hapgrid
