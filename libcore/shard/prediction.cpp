#include "libcore/shard/prediction.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

namespace hapgrid {

namespace {

/// What is not finite counts as 0 in predictions, or it would spread through all rows behind.
double clean(double v) { return std::abs(v) <= std::numeric_limits<double>::max() ? v : 0.0; }
std::uint64_t clean(std::uint64_t v) { return v; }

/// The value at row r on the polynomial through the values of the `order` rows behind it, or of as
/// many as there are. The order of the operations is part of the format.
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

/// Predicts a column row by row. T: double or std::uint64_t.
template <class T>
class Predictor {
 public:
  /// `first` is the value of row 0.
  Predictor(const Stencil& stencil, const Orders& orders, T first, std::vector<T> (&memory)[3])
      : stencil_(stencil), orders_(orders), first_(first) {
    for (std::vector<T>& column : memory) column.resize(stencil.rows());
    x_ = memory[0].data();
    y_ = memory[1].data();
    z_ = memory[2].data();
  }

  /// Takes the value of row r, which value(prediction) answers; all rows in order.
  template <class Value>
  void row(std::size_t r, Value&& value) {
    const auto& [i, j, k] = stencil_.axes;
    const T along_k = extrapolate(k, orders_.k, r, [this](std::size_t b) { return x_[b]; });
    const T along_j = extrapolate(j, orders_.j, r, [this](std::size_t b) { return y_[b]; });
    const T behind = along_j + along_k;
    const T along_i = extrapolate(i, orders_.i, r, [this](std::size_t b) { return z_[b]; });
    T predicted = clean(behind + along_i);
    if (is_alone(stencil_, orders_, r)) predicted = r == 0 ? first_ : x_[stencil_.fallback[r]];
    const T x = clean(value(predicted));
    x_[r] = x;
    y_[r] = x - along_k;
    z_[r] = x - behind;
  }

 private:
  const Stencil& stencil_;
  Orders orders_;
  T first_;
  T* x_;  // the values
  T* y_;  // what k misses of them
  T* z_;  // what j and k miss
};

/// Doubles without their lowest bits as integers that are in the same order; -0 is below +0.
struct OrderedBits {
  explicit OrderedBits(unsigned shift_by)
      : shift(shift_by),
        half(shift_by > 0 ? std::uint64_t{1} << (shift_by - 1) : 0),
        sign(std::uint64_t{1} << (63 - shift_by)),
        mask(~std::uint64_t{0} >> shift_by) {}

  std::uint64_t order(std::uint64_t bits) const {
    return (bits & sign) != 0 ? ~bits & mask : bits | sign;
  }
  std::uint64_t of(double v) const { return order(std::bit_cast<std::uint64_t>(v) >> shift); }
  std::uint64_t rounded(double v) const {
    return order((std::bit_cast<std::uint64_t>(v) + half) >> shift);
  }
  double back(std::uint64_t ordered) const {
    const std::uint64_t bits = (ordered & sign) != 0 ? ordered ^ sign : ~ordered & mask;
    return std::bit_cast<double>(bits << shift);
  }
  /// Small numbers for small differences, of either sign.
  std::uint64_t zigzag(std::uint64_t difference) const {
    return (difference << 1 ^ ((difference & sign) != 0 ? mask : 0)) & mask;
  }
  std::uint64_t unzigzag(std::uint64_t z) const { return (z & mask) >> 1 ^ (0 - (z & 1)); }

  unsigned shift;
  std::uint64_t half, sign, mask;
};

/// Both kinds of columns in one form: T, and a value's residual from its prediction.
struct DoubleResidual {
  std::uint64_t operator()(double value, double predicted) const {
    return bits.zigzag(bits.of(value) - bits.rounded(predicted));
  }
  OrderedBits bits;
};
struct IntegerResidual {
  std::uint64_t operator()(std::uint64_t value, std::uint64_t predicted) const {
    return bits.zigzag(value - predicted);
  }
  OrderedBits bits{0};
};

/// The prediction of one row, from the values alone.
template <class T>
T predict_row(const Stencil& stencil, const Orders& orders, std::span<const T> values,
              std::size_t r) {
  // No structured binding: clang 14 has none in lambdas.
  const BackwardAxis& i = stencil.axes[0];
  const BackwardAxis& j = stencil.axes[1];
  const BackwardAxis& k = stencil.axes[2];
  const auto x = [&](std::size_t b) { return clean(values[b]); };
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

template <class T, class Residual>
Orders choose(const Stencil& stencil, std::span<const T> values, const Residual& residual) {
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
          residual(values[sample[s]], predict_row(stencil, orders, values, sample[s])));
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

void encode_doubles(const Stencil& stencil, Orders orders, unsigned shift,
                    std::span<const double> values, std::span<std::uint64_t> residuals,
                    PredictionScratch& scratch) {
  const DoubleResidual residual{OrderedBits(shift)};
  Predictor<double> predictor(stencil, orders, values[0], scratch.values[0]);
  for (std::size_t r = 0; r < values.size(); ++r)
    predictor.row(r, [&](double predicted) {
      residuals[r] = residual(values[r], predicted);
      return values[r];
    });
}

void decode_doubles(const Stencil& stencil, std::span<const CodedDoubles> columns,
                    std::size_t width, PredictionScratch& scratch) {
  const auto decode = [width](const CodedDoubles& column, const OrderedBits& bits,
                              Predictor<double>& predictor, std::size_t r) {
    predictor.row(r, [&](double predicted) {
      const double value =
          bits.back((bits.rounded(predicted) + bits.unzigzag(column.residuals[r])) & bits.mask);
      column.values[r * width] = value;
      return value;
    });
  };
  while (!columns.empty()) {
    const CodedDoubles a = columns[0];
    const OrderedBits a_bits(a.shift);
    Predictor<double> a_predictor(stencil, a.orders, a.first, scratch.values[0]);
    if (columns.size() == 1) {
      for (std::size_t r = 0; r < stencil.rows(); ++r) decode(a, a_bits, a_predictor, r);
      return;
    }
    // Each value waits for the one before it: two columns at a time keep the processor busy.
    const CodedDoubles b = columns[1];
    const OrderedBits b_bits(b.shift);
    Predictor<double> b_predictor(stencil, b.orders, b.first, scratch.values[1]);
    for (std::size_t r = 0; r < stencil.rows(); ++r) {
      decode(a, a_bits, a_predictor, r);
      decode(b, b_bits, b_predictor, r);
    }
    columns = columns.subspan(2);
  }
}

void encode_integers(const Stencil& stencil, Orders orders, std::span<const std::uint64_t> values,
                     std::span<std::uint64_t> residuals, PredictionScratch& scratch) {
  const IntegerResidual residual;
  Predictor<std::uint64_t> predictor(stencil, orders, values[0], scratch.integers);
  for (std::size_t r = 0; r < values.size(); ++r)
    predictor.row(r, [&](std::uint64_t predicted) {
      residuals[r] = residual(values[r], predicted);
      return values[r];
    });
}

void decode_integers(const Stencil& stencil, Orders orders, double step, std::uint64_t first,
                     std::span<const std::uint64_t> residuals, double* values, std::size_t width,
                     PredictionScratch& scratch) {
  const OrderedBits bits(0);
  Predictor<std::uint64_t> predictor(stencil, orders, first, scratch.integers);
  for (std::size_t r = 0; r < residuals.size(); ++r)
    predictor.row(r, [&](std::uint64_t predicted) {
      const std::uint64_t value = predicted + bits.unzigzag(residuals[r]);
      values[r * width] = static_cast<double>(static_cast<std::int64_t>(value)) * step;
      return value;
    });
}

Orders choose_orders(const Stencil& stencil, unsigned shift, std::span<const double> values) {
  return choose(stencil, values, DoubleResidual{OrderedBits(shift)});
}
Orders choose_orders(const Stencil& stencil, std::span<const std::uint64_t> values) {
  return choose(stencil, values, IntegerResidual{});
}

}  // namespace hapgrid
