// The decoder of schemas/CODING.md, written down once more from that page, row by row and column by
// column; it shares no code with libcore's.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace reference {

struct Row {
  std::uint64_t point;
  unsigned level;
  std::array<unsigned, 3> back;  // links in the directions -i, -j, -k
};

/// Neighbours along i, j, k; -1 where there is none.
struct Way {
  std::array<int, 3> neighbour;
  std::array<unsigned, 3> depth;
  int fallback;
};

inline std::vector<Way> ways(const std::vector<Row>& rows, const std::array<std::uint64_t, 3>& n) {
  const std::array<std::uint64_t, 3> stride{1, n[0], n[0] * n[1]};
  std::map<std::pair<std::uint64_t, unsigned>, int> known;
  std::vector<Way> result;
  for (int r = 0; r < static_cast<int>(rows.size()); ++r) {
    const Row& row = rows[static_cast<std::size_t>(r)];
    Way way{{-1, -1, -1}, {0, 0, 0}, r - 1};
    for (std::size_t a = 0; a < 3; ++a) {
      if (row.back[a] >= 254 || row.point < stride[a]) continue;
      const auto found = known.find({row.point - stride[a], row.back[a]});
      if (found != known.end()) way.neighbour[a] = found->second;
    }
    known[{row.point, row.level}] = r;
    for (const std::size_t a : {2, 1, 0}) {
      if (way.neighbour[a] < 0) continue;
      way.fallback = way.neighbour[a];
      const Way& there = result[static_cast<std::size_t>(way.neighbour[a])];
      bool same = true;
      for (std::size_t b = a + 1; b < 3; ++b) same &= there.depth[b] == way.depth[b];
      if (same) way.depth[a] = std::min(3u, there.depth[a] + 1);
    }
    result.push_back(way);
  }
  return result;
}

/// E(v, a, r), of doubles or integers.
template <class T>
T extrapolate(const std::vector<T>& v, const std::vector<Way>& ways, std::size_t a, unsigned order,
              std::size_t r) {
  const auto back = [&](std::size_t from) {
    return static_cast<std::size_t>(ways[from].neighbour[a]);
  };
  const unsigned m = std::min(order, ways[r].depth[a]);
  if (m == 0) return 0;
  const T v1 = v[back(r)];
  if (m == 1) return v1;
  const T v2 = v[back(back(r))];
  if (m == 2) return 2 * v1 - v2;
  return 3 * v1 - (3 * v2 - v[back(back(back(r)))]);
}

inline double finite(double v) { return std::isfinite(v) ? v : 0; }
inline std::uint64_t finite(std::uint64_t v) { return v; }

/// `value(r, P)` answers the value of row r.
template <class T, class Value>
void column(const std::vector<Way>& ways, unsigned orders, T first, Value&& value) {
  const unsigned of[3] = {orders % 4, orders / 4 % 4, orders / 16};
  std::vector<T> x, y, z;
  for (std::size_t r = 0; r < ways.size(); ++r) {
    const T k = extrapolate(x, ways, 2, of[2], r);
    const T b = extrapolate(y, ways, 1, of[1], r) + k;
    T p = finite(b + extrapolate(z, ways, 0, of[0], r));
    bool alone = true;
    for (std::size_t a = 0; a < 3; ++a) alone &= std::min(of[a], ways[r].depth[a]) == 0;
    if (alone) p = r == 0 ? first : x[static_cast<std::size_t>(ways[r].fallback)];
    x.push_back(finite(value(r, p)));
    y.push_back(x[r] - k);
    z.push_back(x[r] - b);
  }
}

/// A residual without its zigzag.
inline std::uint64_t difference(std::uint64_t z) {
  return z % 2 == 0 ? z / 2 : std::uint64_t{0} - z / 2 - 1;
}

/// The place of a double of w = 64 - s bits among all of them.
inline std::uint64_t order(std::uint64_t u, unsigned w) {
  const std::uint64_t half = std::uint64_t{1} << (w - 1);
  return u < half ? u + half : half - 1 - (u - half);
}

inline std::vector<double> decode_doubles(const std::vector<Way>& ways, unsigned orders, unsigned s,
                                          double first,
                                          const std::vector<std::uint64_t>& residuals) {
  const unsigned w = 64 - s;
  const std::uint64_t half = std::uint64_t{1} << (w - 1);
  const std::uint64_t largest = half - 1 + half;
  std::vector<double> values;
  column(ways, orders, first, [&](std::size_t r, double p) {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(p);
    const std::uint64_t rounded = s > 0 ? bits + (std::uint64_t{1} << (s - 1)) : bits;
    const std::uint64_t place = (order(rounded >> s, w) + difference(residuals[r])) & largest;
    const std::uint64_t u = place >= half ? place - half : largest - place;
    values.push_back(std::bit_cast<double>(u << s));
    return values.back();
  });
  return values;
}

inline std::vector<double> decode_integers(const std::vector<Way>& ways, unsigned orders,
                                           double bound, std::uint64_t first,
                                           const std::vector<std::uint64_t>& residuals) {
  std::vector<double> values;
  column(ways, orders, first, [&](std::size_t r, std::uint64_t p) {
    const std::uint64_t whole = p + difference(residuals[r]);
    values.push_back(static_cast<double>(static_cast<std::int64_t>(whole)) *
                     (1.9990234375 * bound));
    return whole;
  });
  return values;
}

}  // namespace reference
