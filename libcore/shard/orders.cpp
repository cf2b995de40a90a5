#include "libcore/shard/orders.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

#include "libcore/base/zigzag.hpp"
#include "libcore/shard/places.hpp"

namespace hapgrid {

namespace {

/// What is not finite counts as 0 in predictions, or it would spread through all rows behind.
double clean(double v) { return std::abs(v) <= std::numeric_limits<double>::max() ? v : 0.0; }
std::uint64_t clean(std::uint64_t v) { return v; }

/// The value at row r on the polynomial through the values of the `order` rows behind it, or of as
/// many as there are.
template <class At>
auto extrapolate(const BackwardAxis& axis, unsigned order, std::size_t r, At&& at)
    -> std::decay_t<decltype(at(r))> {
  switch (std::min<unsigned>(order, axis.depth[r])) {
    case 0:
      return 0;
    case 1:
      return at(axis.back[r]);
    case 2: {
      const std::uint32_t one = axis.back[r];
      const auto a = at(one), b = at(axis.back[one]);
      return 2 * a - b;
    }
    default: {
      const std::uint32_t one = axis.back[r], two = axis.back[one];
      const auto a = at(one), b = at(two), c = at(axis.back[two]);
      return 3 * a - (3 * b - c);
    }
  }
}

bool is_alone(const Stencil& stencil, const Orders& orders, std::size_t r) {
  const auto& [i, j, k] = stencil.axes;
  return (orders.i == 0 || i.depth[r] == 0) && (orders.j == 0 || j.depth[r] == 0) &&
         (orders.k == 0 || k.depth[r] == 0);
}

/// The prediction of one row (prediction.hpp), from the values alone: few rows are tried, so what
/// the rows behind them miss is computed for each. T: double or std::uint64_t.
template <class T>
T predict_row(const Stencil& stencil, const Orders& orders, std::span<const std::uint64_t> values,
              std::size_t r) {
  // No structured binding: clang 14 has none in lambdas.
  const BackwardAxis& i = stencil.axes[0];
  const BackwardAxis& j = stencil.axes[1];
  const BackwardAxis& k = stencil.axes[2];
  const auto x = [&](std::size_t b) { return clean(std::bit_cast<T>(values[b])); };
  if (is_alone(stencil, orders, r)) return x(stencil.fallback[r]);
  const auto along_k = [&](std::size_t b) { return extrapolate(k, orders.k, b, x); };
  const auto y = [&](std::size_t b) { return x(b) - along_k(b); };
  const auto along_j = [&](std::size_t b) { return extrapolate(j, orders.j, b, y); };
  const auto behind = [&](std::size_t b) { return along_j(b) + along_k(b); };
  const auto z = [&](std::size_t b) { return x(b) - behind(b); };
  return clean(behind(r) + extrapolate(i, orders.i, r, z));
}

/// 16 log2(v + 1), near enough. In integers: what is chosen shows in the bytes, which must be the
/// same with every C library.
std::uint64_t sixteenth_bits(std::uint64_t v) {
  const std::uint64_t u = v + (v < ~std::uint64_t{0});
  const auto width = static_cast<unsigned>(std::bit_width(u));
  return 16 * (width - 1) + (u << (64 - width) >> 59 & 15);
}

/// `residual` of a value and its prediction, both std::uint64_t and T.
template <class T, class Residual>
Orders choose(const Stencil& stencil, std::span<const std::uint64_t> values,
              const Residual& residual) {
  // Rows all over the chunk: a stride would meet the same column of the grid again and again.
  constexpr std::size_t kSample = 256;
  std::uint32_t sample[kSample];
  std::size_t size = 0;
  if (values.size() <= kSample) {
    for (; size < values.size(); ++size) sample[size] = static_cast<std::uint32_t>(size);
  } else {
    for (std::uint64_t state = 1; size < kSample; ++size) {
      state = state * 6364136223846793005 + 1442695040888963407;  // Knuth's generator
      sample[size] = static_cast<std::uint32_t>((state >> 32) * values.size() >> 32);
    }
  }
  const auto cost = [&](const Orders& orders) {
    std::uint64_t sum = 0;
    for (std::size_t s = 0; s < size; ++s)
      sum += sixteenth_bits(
          residual(values[sample[s]], predict_row<T>(stencil, orders, values, sample[s])));
    return sum;
  };
  // Axis by axis, and once more, as the first choice knew nothing of the later ones.
  Orders best{1, 1, 1};
  std::uint64_t least = cost(best);
  for (int sweep = 0; sweep < 2; ++sweep)
    for (std::uint8_t Orders::*axis : {&Orders::i, &Orders::j, &Orders::k}) {
      Orders tried = best;
      for (std::uint8_t order = 0; order <= BackwardAxis::kMaxDepth; ++order) {
        tried.*axis = order;
        if (order == best.*axis) continue;
        const std::uint64_t bits = cost(tried);
        if (bits >= least) continue;
        least = bits;
        best = tried;
      }
    }
  return best;
}

}  // namespace

Orders choose_orders_of_doubles(const Stencil& stencil, unsigned shift,
                                std::span<const std::uint64_t> values) {
  const Places<std::uint64_t> places = places_of_doubles(shift);
  return choose<double>(stencil, values, [&](std::uint64_t value, double predicted) {
    return places.residual(value, std::bit_cast<std::uint64_t>(predicted));
  });
}

Orders choose_orders_of_integers(const Stencil& stencil, std::span<const std::uint64_t> values) {
  return choose<std::uint64_t>(stencil, values, [](std::uint64_t value, std::uint64_t predicted) {
    return zigzag(value - predicted);
  });
}

}  // namespace hapgrid
