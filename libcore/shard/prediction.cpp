#include "libcore/shard/prediction.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <type_traits>

#include "libcore/base/zigzag.hpp"
#include "libcore/shard/places.hpp"

namespace hapgrid {

namespace {

// Each value waits for the one before it in its column, so columns are computed side by side: two
// in a vector, one in each lane, and several vectors, which keeps the processor busy while it
// waits. Vectors of two are what every x86-64 and ARM64 has; four, with AVX2, made decoding 1.2
// times as fast, which was not worth a second build of it.
constexpr std::size_t kLanes = 2;
constexpr std::size_t kMostColumns = 16;

using Doubles [[gnu::vector_size(16)]] = double;
using Bits [[gnu::vector_size(16)]] = std::uint64_t;

/// A vector of T, which is double or std::uint64_t.
template <class T>
using Vector = std::conditional_t<std::is_same_v<T, double>, Doubles, Bits>;

template <class V>
V masked(V v, Bits mask) {
  return std::bit_cast<V>(std::bit_cast<Bits>(v) & mask);
}

/// What is not finite counts as 0 in predictions, or it would spread through all rows behind.
Doubles clean(Doubles v) {
  const Doubles magnitude = masked(v, ~Bits{kSignBit, kSignBit});
  return masked(v, std::bit_cast<Bits>(magnitude <= std::numeric_limits<double>::max()));
}
Bits clean(Bits v) { return v; }

/// E of schemas/CODING.md for rows of one depth along one axis, where each lane has its own order
/// m: masks leave out what an order does not use, whatever is there.
template <class T>
struct Extrapolation {
  using V = Vector<T>;

  void set(std::size_t lane, unsigned m) {
    one[lane] = m >= 1 ? ~std::uint64_t{0} : 0;
    two[lane] = m >= 2 ? ~std::uint64_t{0} : 0;
    three[lane] = m >= 3 ? ~std::uint64_t{0} : 0;
    times_a[lane] = std::max(m, 1u);
    times_b[lane] = m >= 3 ? 3 : 1;
  }

  /// From the values one, two and three steps back.
  V operator()(V a, V b, V c) const {
    if constexpr (std::is_same_v<T, double>) {
      // Times 1 and minus +0 change no bit: these are the operations of the order alone.
      return masked(times_a * a - masked(times_b * b - masked(c, three), two), one);
    } else {
      const V step = a - b;  // no vectors multiply such integers before AVX-512
      return (a + (step & two) + ((step - (b - c)) & three)) & one;
    }
  }

  Bits one, two, three;  // all bits where m is that at least
  V times_a, times_b;
};

/// The columns of one vector.
template <class T>
struct Group {
  void set(std::size_t lane, const PredictedColumn& column) {
    numbers[lane] = column.numbers;
    const std::uint8_t orders[3] = {column.orders.i, column.orders.j, column.orders.k};
    for (std::size_t a = 0; a < 3; ++a)
      for (unsigned depth = 0; depth <= BackwardAxis::kMaxDepth; ++depth)
        along[a][depth].set(lane, std::min<unsigned>(orders[a], depth));
    const Places<std::uint64_t> own = places_of_doubles(column.shift);
    places.half[lane] = own.half;
    places.kept[lane] = own.kept;
    places.shift[lane] = own.shift;
  }

  Bits residual(Bits value, Bits predicted) const {
    if constexpr (std::is_same_v<T, double>) return places.residual(value, predicted);
    return zigzag(value - predicted);
  }
  Bits value(Bits residual, Bits predicted) const {
    if constexpr (std::is_same_v<T, double>) return places.value(residual, predicted);
    return predicted + unzigzag(residual);
  }

  Extrapolation<T> along[3][BackwardAxis::kMaxDepth + 1];
  Places<Bits> places;  // of doubles
  std::uint64_t* numbers[kLanes];
};

/// A vector for each group and each of the last rows: few enough to stay in the cache. It is used
/// as a local copy, which stays in registers: what is written through it could be a member.
template <class V>
struct Window {
  V& at(std::size_t row, std::size_t group) const { return data[(row & mask) * groups + group].v; }

  struct Held {
    V v;
  };
  Held* data = nullptr;
  std::size_t groups = 0;
  std::size_t mask = 0;
};

/// Memory of a window.
template <class V>
class WindowMemory {
 public:
  /// Keeps `reach` rows behind the last at least, or all `rows` of the chunk.
  void begin(std::size_t reach, std::size_t rows, std::size_t groups) {
    rows = std::bit_ceil(std::min(reach + 1, rows));
    memory_.resize(rows * groups);
    window_ = {memory_.data(), groups, rows - 1};
  }
  Window<V> window() const { return window_; }

 private:
  std::vector<typename Window<V>::Held> memory_;
  Window<V> window_;
};

/// The rows one, two and three steps behind row r along an axis; any rows where there are none.
struct Behind {
  Behind(const BackwardAxis& axis, std::size_t r)
      : depth(axis.depth[r]), a(axis.back[r]), b(axis.back[a]), c(axis.back[b]) {}

  std::size_t depth, a, b, c;
};

}  // namespace

/// Columns that are computed side by side.
template <class T>
struct Predictor<T>::Set {
  using V = Vector<T>;

  void begin(const Stencil& stencil, std::span<const PredictedColumn> columns) {
    count = (columns.size() + kLanes - 1) / kLanes;
    const auto [step_i, step_j, step_k] = stencil.farthest;
    constexpr std::uint32_t kDepth = BackwardAxis::kMaxDepth;
    const std::size_t rows = stencil.rows();
    values.begin(std::max({kDepth * step_k, step_j, step_i, 1u}), rows, count);
    missed_by_k.begin(kDepth * step_j, rows, count);
    missed_by_jk.begin(kDepth * step_i, rows, count);
    for (std::size_t g = 0; g < count; ++g) {
      Bits first{};
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        // The last column fills the lane that is left.
        const PredictedColumn& column = columns[std::min(g * kLanes + lane, columns.size() - 1)];
        groups[g].set(lane, column);
        first[lane] = column.first;
      }
      values.window().at(0, g) = std::bit_cast<V>(first);  // where row 0 finds its prediction
    }
  }

  /// Rows [begin, end). Makes values of residuals, or residuals of values.
  template <bool kDecode>
  void code(const Stencil& stencil, std::size_t begin, std::size_t end) {
    const Window<V> x = values.window(), y = missed_by_k.window(), z = missed_by_jk.window();
    for (std::size_t r = begin; r < end; ++r) {
      const Behind i(stencil.axes[0], r), j(stencil.axes[1], r), k(stencil.axes[2], r);
      const std::size_t fallback = stencil.fallback[r];
      for (std::size_t g = 0; g < count; ++g) {
        const Group<T>& group = groups[g];
        const Extrapolation<T>& along_i = group.along[0][i.depth];
        const Extrapolation<T>& along_j = group.along[1][j.depth];
        const Extrapolation<T>& along_k = group.along[2][k.depth];
        const V by_k = along_k(x.at(k.a, g), x.at(k.b, g), x.at(k.c, g));
        const V by_jk = along_j(y.at(j.a, g), y.at(j.b, g), y.at(j.c, g)) + by_k;
        const V by_all = clean(by_jk + along_i(z.at(i.a, g), z.at(i.b, g), z.at(i.c, g)));
        const Bits any = along_i.one | along_j.one | along_k.one;
        const Bits predicted = std::bit_cast<Bits>(masked(by_all, any)) |
                               std::bit_cast<Bits>(masked(x.at(fallback, g), ~any));

        std::uint64_t* const numbers[kLanes] = {group.numbers[0] + (r - begin),
                                                group.numbers[1] + (r - begin)};
        const Bits from{*numbers[0], *numbers[1]};
        const Bits to = kDecode ? group.value(from, predicted) : group.residual(from, predicted);
        for (std::size_t lane = 0; lane < kLanes; ++lane) *numbers[lane] = to[lane];

        const V value = clean(std::bit_cast<V>(kDecode ? to : from));
        x.at(r, g) = value;
        y.at(r, g) = value - by_k;
        z.at(r, g) = value - by_jk;
      }
    }
  }

  std::size_t count = 0;
  Group<T> groups[kMostColumns / kLanes];
  WindowMemory<V> values;
  WindowMemory<V> missed_by_k;
  WindowMemory<V> missed_by_jk;
};

template <class T>
Predictor<T>::Predictor() = default;
template <class T>
Predictor<T>::~Predictor() = default;

template <class T>
void Predictor<T>::begin(const Stencil& stencil, std::span<const PredictedColumn> columns) {
  stencil_ = &stencil;
  next_ = 0;
  used_ = 0;
  for (; !columns.empty(); ++used_) {
    if (used_ == sets_.size()) sets_.emplace_back();
    const std::size_t some = std::min(kMostColumns, columns.size());
    sets_[used_].begin(stencil, columns.first(some));
    columns = columns.subspan(some);
  }
}

template <class T>
void Predictor<T>::encode(std::size_t count) {
  code<false>(count);
}

template <class T>
void Predictor<T>::decode(std::size_t count) {
  code<true>(count);
}

template <class T>
template <bool kDecode>
void Predictor<T>::code(std::size_t count) {
  for (std::size_t s = 0; s < used_; ++s)
    sets_[s].template code<kDecode>(*stencil_, next_, next_ + count);
  next_ += count;
}

template class Predictor<double>;
template class Predictor<std::uint64_t>;

}  // namespace hapgrid
