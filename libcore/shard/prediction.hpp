// One column of numbers predicted from the rows before, so that little is left to be stored.
//
// A smooth field is near a polynomial along each axis. Along k a value is extrapolated from the
// values behind it with a polynomial through `order` of them; what that misses, y, is extrapolated
// along j from the y behind it, what that misses along i, and the three sum up to the prediction.
// That is Lorenzo's predictor (Ibarria et al., 2003) where all orders are 1, and with higher orders
// it costs a few operations more instead of many neighbours. Higher orders amplify rounding noise,
// so the encoder tries which are best for the column at hand.
//
// Alternatives, on smooth fields of floats with n = 9 and 64^3 points: Lorenzo's predictor on the
// ordered integers of the bits breaks where the exponent changes (17 bytes a record; this one 8);
// zfp's reversible mode (14) is a library more and works on dense blocks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/shard/stencil.hpp"

namespace hapgrid {

/// How many rows back a column is predicted along each axis; 0 to 3 each.
struct Orders {
  std::uint8_t i = 0;
  std::uint8_t j = 0;
  std::uint8_t k = 0;

  std::uint8_t packed() const { return static_cast<std::uint8_t>(i | j << 2 | k << 4); }
  /// Takes the six lowest bits.
  static Orders unpacked(std::uint8_t packed) {
    return {static_cast<std::uint8_t>(packed & 3), static_cast<std::uint8_t>(packed >> 2 & 3),
            static_cast<std::uint8_t>(packed >> 4 & 3)};
  }
};

/// Memory that the functions below use again from column to column.
struct PredictionScratch {
  std::vector<double> values[2][3];
  std::vector<std::uint64_t> integers[3];
};

/// Doubles, bit by bit, of which the `shift` lowest bits are all 0: residual r is value r minus its
/// prediction, counted in representable values, zigzag; residual 0 is 0, as value 0 is kept beside
/// the residuals. Shapes: R each; shift 0 to 52.
void encode_doubles(const Stencil& stencil, Orders orders, unsigned shift,
                    std::span<const double> values, std::span<std::uint64_t> residuals,
                    PredictionScratch& scratch);
/// One column to be decoded: value r goes to values[r * width].
struct CodedDoubles {
  Orders orders;
  unsigned shift;
  double first;
  const std::uint64_t* residuals;
  double* values;
};
/// The other way, for any number of columns. Never fails, whatever the residuals are.
void decode_doubles(const Stencil& stencil, std::span<const CodedDoubles> columns,
                    std::size_t width, PredictionScratch& scratch);

/// The same for integers, modulo 2^64.
void encode_integers(const Stencil& stencil, Orders orders, std::span<const std::uint64_t> values,
                     std::span<std::uint64_t> residuals, PredictionScratch& scratch);
/// Value r, times `step`, goes to values[r * width].
void decode_integers(const Stencil& stencil, Orders orders, double step, std::uint64_t first,
                     std::span<const std::uint64_t> residuals, double* values, std::size_t width,
                     PredictionScratch& scratch);

/// Orders that leave small residuals, by trial on some of the rows: the same for the same column.
Orders choose_orders(const Stencil& stencil, unsigned shift, std::span<const double> values);
Orders choose_orders(const Stencil& stencil, std::span<const std::uint64_t> values);

}  // namespace hapgrid
