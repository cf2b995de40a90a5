// Columns of numbers predicted from the rows before, so that little is left to be stored.
//
// A smooth field is near a polynomial along each axis. Along k a value is extrapolated from the
// values behind it with a polynomial through `order` of them; what that misses, y, is extrapolated
// along j from the y behind it, what that misses along i, and the three sum up to the prediction.
// That is Lorenzo's predictor (Ibarria et al., 2003) where all orders are 1, and with higher orders
// it costs a few operations more instead of many neighbours. Higher orders amplify rounding noise,
// so the encoder tries which are best for the column at hand (orders.hpp).
//
// Alternatives, on smooth fields of floats with n = 9 and 64^3 points: Lorenzo's predictor on the
// ordered integers of the bits breaks where the exponent changes (17 bytes a record; this one 8);
// zfp's reversible mode (14) is a library more and works on dense blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/shard/orders.hpp"
#include "libcore/shard/stencil.hpp"

namespace hapgrid {

/// How one column of a chunk is predicted, and where some of its numbers are: values before they
/// are encoded, residuals after it, and the other way round. A residual is the value minus its
/// prediction, zigzag; that of row 0 is 0, as its value is kept beside them.
struct PredictedColumn {
  Orders orders;
  unsigned shift;          ///< of doubles: how many of the lowest bits are 0 in all values, 0 to 52
  std::uint64_t first;     ///< the value of row 0
  std::uint64_t* numbers;  ///< of the rows that are coded next
};

/// Predicts columns of one chunk, row by row. T is double, where values are the bits of doubles and
/// residuals count representable doubles without their `shift` lowest bits; or std::uint64_t, where
/// both are integers modulo 2^64.
template <class T>
class Predictor {
 public:
  Predictor();
  ~Predictor();

  /// Before the first row of a chunk; any number of columns. `stencil`, and what the columns point
  /// to, must live until the last row.
  void begin(const Stencil& stencil, std::span<const PredictedColumn> columns);
  /// The next `count` rows: numbers[0] to numbers[count - 1] of each column.
  void encode(std::size_t count);
  /// Never fails, whatever the residuals are.
  void decode(std::size_t count);

 private:
  struct Set;
  template <bool kDecode>
  void code(std::size_t count);

  const Stencil* stencil_ = nullptr;
  std::size_t next_ = 0;
  std::size_t used_ = 0;
  std::vector<Set> sets_;  // some are of an earlier chunk: their memory is used again
};

extern template class Predictor<double>;
extern template class Predictor<std::uint64_t>;

}  // namespace hapgrid
