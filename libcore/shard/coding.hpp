// A chunk of a finished grid, made small and back: schemas/CODING.md is the format's page.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/shard/format.hpp"
#include "libcore/shard/prediction.hpp"
#include "libcore/shard/stencil.hpp"

namespace hapgrid {

/// A column whose values are multiples of its step, instead of a shift.
inline constexpr std::uint8_t kSteps = 255;

/// The step of a column that may be off by `bound`; a little less than twice the bound, so that
/// the product's rounding does not break it.
inline double step_of(double bound) { return bound * 1.9990234375; }

/// One chunk as schemas/shard.capnp has it. Bytes: std::vector<std::uint8_t> to write, a span to
/// read.
template <class Bytes>
struct CodedChunk {
  std::uint32_t rows = 0;
  Bytes point;
  Bytes level;
  Bytes links;
  Bytes generation;
  Bytes order;
  Bytes shift;
  Bytes planes;
  Bytes residuals;
  Bytes first;
};

/// Codes chunks of one section, reusing its memory.
class ChunkEncoder {
 public:
  explicit ChunkEncoder(const SectionHeader& header)
      : counts_(header.spec.box.counts), width_(row_size(header)), coding_(header.coding) {}

  /// `rows`: R records of a grid, with `numbers` R x row_size(header). Numbers of a column with a
  /// bound may change by it; a column that cannot be kept within its bound (its numbers are not
  /// finite, or too large for it) keeps its bits. The result is valid until the next call.
  const CodedChunk<std::vector<std::uint8_t>>& encode(const RecordRows& rows);

 private:
  void encode_numbers(const RecordRows& rows);
  /// `numbers`: the bits of column c. Makes them what is predicted, and says how.
  PredictedColumn prepare_column(std::size_t c, std::span<std::uint64_t> numbers);

  GridCoordinates counts_;
  std::uint32_t width_;
  Coding coding_;
  CodedChunk<std::vector<std::uint8_t>> coded_;
  Stencil stencil_;
  Predictor<double> doubles_;
  Predictor<std::uint64_t> integers_;
  std::vector<std::uint32_t> differences_;
  std::vector<std::uint64_t> multiples_;
  std::vector<std::uint64_t> numbers_;  // W x R
  std::vector<PredictedColumn> double_columns_, integer_columns_;
};

/// Decodes chunks of one section, reusing its memory.
class ChunkDecoder {
 public:
  explicit ChunkDecoder(const SectionHeader& header)
      : counts_(header.spec.box.counts),
        width_(row_size(header)),
        shape_offset_(header.spec.shape_offset()),
        coding_(header.coding) {}

  /// Fills in all of `rows` but the message; level and links look into `coded`.
  /// @throw FormatError when columns do not fit together, before memory is taken for them, or a
  /// shape is no floats.
  void decode(const CodedChunk<std::span<const std::uint8_t>>& coded, RecordRows& rows);

 private:
  void decode_numbers(const CodedChunk<std::span<const std::uint8_t>>& coded,
                      std::vector<double>& numbers);

  GridCoordinates counts_;
  std::uint32_t width_;
  std::uint32_t shape_offset_;
  Coding coding_;
  Stencil stencil_;
  Predictor<double> doubles_;
  Predictor<std::uint64_t> integers_;
  std::vector<std::uint64_t> numbers_;  // of some rows, column by column
  std::vector<PredictedColumn> double_columns_, integer_columns_;
};

}  // namespace hapgrid
