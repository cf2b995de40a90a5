#include "libcore/shard/coding.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "libcore/base/error.hpp"
#include "libcore/base/zigzag.hpp"
#include "libcore/shard/planes.hpp"

namespace hapgrid {

namespace {

constexpr unsigned kMaxShift = 52;  // the mantissa's bits

// Beyond, the rounding of multiple * step comes near the bound. It is checked in any case.
constexpr double kMaxMultiple = 1099511627776;  // 2^40

/// How many of the lowest bits are 0 in each of the values; of floats at least 29.
unsigned common_shift(std::span<const std::uint64_t> values) {
  std::uint64_t all = 0;
  for (const std::uint64_t v : values) all |= v;
  return std::min(kMaxShift, static_cast<unsigned>(std::countr_zero(all)));
}

/// Doubles as multiples of the step, in place; false when one of them would be off by more than
/// `bound`, and then nothing is done. `multiples` is memory for it.
bool to_multiples(std::span<std::uint64_t> values, double bound,
                  std::vector<std::uint64_t>& multiples) {
  const double step = step_of(bound);
  if (!(bound >= std::numeric_limits<double>::min()) || !std::isfinite(step)) return false;
  multiples.resize(values.size());
  for (std::size_t r = 0; r < values.size(); ++r) {
    const double v = std::bit_cast<double>(values[r]);
    const double multiple = std::nearbyint(v / step);
    // Written so that NaN is refused.
    if (!(std::abs(multiple) <= kMaxMultiple) || !(std::abs(multiple * step - v) <= bound))
      return false;
    multiples[r] = static_cast<std::uint64_t>(static_cast<std::int64_t>(multiple));
  }
  std::copy(multiples.begin(), multiples.end(), values.begin());
  return true;
}

void require_size(std::span<const std::uint8_t> column, std::uint64_t size, const char* name) {
  if (column.size() != size)
    throw FormatError(std::string("column ") + name + " does not fit the chunk");
}

}  // namespace

const CodedChunk<std::vector<std::uint8_t>>& ChunkEncoder::encode(const RecordRows& rows) {
  const std::size_t count = rows.size();
  coded_.rows = static_cast<std::uint32_t>(count);
  differences_.resize(count);
  for (std::size_t r = 0; r < count; ++r)
    differences_[r] = rows.point[r] - (r > 0 ? rows.point[r - 1] : 0);
  coded_.point.resize(4 * count);
  split_planes<std::uint32_t>(differences_, 4, coded_.point.data());
  for (std::size_t r = 0; r < count; ++r)
    differences_[r] = zigzag(rows.generation[r] - (r > 0 ? rows.generation[r - 1] : 0), 32);
  coded_.generation.resize(4 * count);
  split_planes<std::uint32_t>(differences_, 4, coded_.generation.data());
  coded_.level.assign(rows.level.begin(), rows.level.end());
  coded_.links.assign(rows.links.begin(), rows.links.end());

  stencil_.find(rows.point, rows.level, rows.links, counts_);
  encode_numbers(rows);
  return coded_;
}

void ChunkEncoder::encode_numbers(const RecordRows& rows) {
  const std::size_t count = rows.size();
  coded_.order.resize(width_);
  coded_.shift.resize(width_);
  coded_.planes.resize(width_);
  coded_.first.resize(8 * std::size_t{width_});
  numbers_.resize(width_ * count);
  double_columns_.clear();
  integer_columns_.clear();
  const auto column = [&](std::size_t c) { return std::span(numbers_).subspan(c * count, count); };
  for (std::size_t c = 0; c < width_; ++c) {
    for (std::size_t r = 0; r < count; ++r)
      column(c)[r] = std::bit_cast<std::uint64_t>(rows.numbers[r * width_ + c]);
    const PredictedColumn predicted = prepare_column(c, column(c));
    (coded_.shift[c] == kSteps ? integer_columns_ : double_columns_).push_back(predicted);
  }
  doubles_.begin(stencil_, double_columns_);
  doubles_.encode(count);
  integers_.begin(stencil_, integer_columns_);
  integers_.encode(count);
  coded_.residuals.clear();
  for (std::size_t c = 0; c < width_; ++c) {
    const std::span<const std::uint64_t> residuals = column(c);
    const unsigned planes = planes_needed(residuals);
    coded_.planes[c] = static_cast<std::uint8_t>(planes);
    const std::size_t begin = coded_.residuals.size();
    coded_.residuals.resize(begin + planes * count);
    split_planes(residuals, planes, coded_.residuals.data() + begin);
  }
}

PredictedColumn ChunkEncoder::prepare_column(std::size_t c, std::span<std::uint64_t> numbers) {
  PredictedColumn column{};
  column.numbers = numbers.data();
  const double bound = coding_.is_lossy() ? coding_.bounds[c] : 0;
  if (bound > 0 && to_multiples(numbers, bound, multiples_)) {
    coded_.shift[c] = kSteps;
    column.orders = choose_orders_of_integers(stencil_, numbers);
  } else {
    column.shift = common_shift(numbers);
    coded_.shift[c] = static_cast<std::uint8_t>(column.shift);
    column.orders = choose_orders_of_doubles(stencil_, column.shift, numbers);
  }
  coded_.order[c] = column.orders.packed();
  column.first = numbers[0];
  std::memcpy(&coded_.first[8 * c], &column.first, sizeof column.first);
  return column;
}

void ChunkDecoder::decode(const CodedChunk<std::span<const std::uint8_t>>& coded,
                          RecordRows& rows) {
  const std::uint32_t limit = coded_chunk_points(width_);
  if (coded.rows == 0) throw FormatError("damaged: a chunk without rows");
  if (coded.rows > limit)
    throw FormatError("a coded chunk of " + std::to_string(coded.rows) + " rows, the limit is " +
                      std::to_string(limit));
  const std::size_t count = coded.rows;
  require_size(coded.point, 4 * count, "point");
  require_size(coded.level, count, "level");
  require_size(coded.links, count * kDirections, "links");
  require_size(coded.generation, 4 * count, "generation");
  require_size(coded.order, width_, "order");
  require_size(coded.shift, width_, "shift");
  require_size(coded.planes, width_, "planes");
  require_size(coded.first, 8 * std::uint64_t{width_}, "first");
  std::uint64_t planes = 0;
  for (std::size_t c = 0; c < width_; ++c) {
    const bool fits = coded.shift[c] == kSteps ? coding_.is_lossy() : coded.shift[c] <= kMaxShift;
    if (!fits || coded.planes[c] > kMaxPlanes || coded.order[c] >= 64)
      throw FormatError("damaged: impossible coding of column " + std::to_string(c));
    planes += coded.planes[c];
  }
  require_size(coded.residuals, planes * count, "residuals");

  rows.coded_point.resize(count);
  join_planes<PointIndex>(coded.point.data(), count, 4, rows.coded_point);
  std::uint64_t point = 0;
  for (PointIndex& p : rows.coded_point) {
    point += p;
    if (point > std::numeric_limits<PointIndex>::max())
      throw FormatError("damaged: a point beyond any box");
    p = static_cast<PointIndex>(point);
  }
  if (point - rows.coded_point.front() >= limit)
    throw FormatError("damaged: a coded chunk spans too many points");
  rows.coded_generation.resize(count);
  join_planes<std::uint32_t>(coded.generation.data(), count, 4, rows.coded_generation);
  std::uint32_t generation = 0;
  for (std::uint32_t& g : rows.coded_generation) g = generation += unzigzag(g);
  rows.point = rows.coded_point;
  rows.generation = rows.coded_generation;
  rows.level = coded.level;
  rows.links = coded.links;
  rows.todo = {};

  stencil_.find(rows.point, rows.level, rows.links, counts_);
  rows.width = width_;
  rows.transposed.resize(count * width_);
  rows.numbers = rows.transposed;
  decode_numbers(coded, rows.transposed);
  for (std::size_t c = shape_offset_; c < width_; ++c)
    for (std::size_t r = 0; r < count; ++r) {
      const double v = std::abs(rows.transposed[r * width_ + c]);
      if (std::isfinite(v) && v > std::numeric_limits<float>::max())
        throw FormatError("damaged: a shape with a number beyond any float");
    }
}

void ChunkDecoder::decode_numbers(const CodedChunk<std::span<const std::uint8_t>>& coded,
                                  std::vector<double>& numbers) {
  const std::size_t count = coded.rows;
  // All columns of some rows, so that they stay in the cache until they are rows: 256 KiB.
  const std::size_t block = std::min(std::clamp<std::size_t>(32768 / width_, 16, 256), count);
  numbers_.resize(width_ * block);
  const auto column = [&](std::size_t c) { return std::span(numbers_).subspan(c * block, block); };
  double_columns_.clear();
  integer_columns_.clear();
  for (std::size_t c = 0; c < width_; ++c) {
    const bool is_steps = coded.shift[c] == kSteps;
    PredictedColumn predicted{Orders::unpacked(coded.order[c]), is_steps ? 0u : coded.shift[c], 0,
                              column(c).data()};
    std::memcpy(&predicted.first, &coded.first[8 * c], sizeof predicted.first);
    (is_steps ? integer_columns_ : double_columns_).push_back(predicted);
  }
  doubles_.begin(stencil_, double_columns_);
  integers_.begin(stencil_, integer_columns_);
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t some = std::min(block, count - begin);
    const std::uint8_t* bytes = coded.residuals.data() + begin;
    for (std::size_t c = 0; c < width_; ++c) {
      join_planes(bytes, count, coded.planes[c], column(c).first(some));
      bytes += coded.planes[c] * count;
    }
    doubles_.decode(some);
    integers_.decode(some);
    for (std::size_t c = 0; c < width_; ++c) {
      const std::span<const std::uint64_t> values = column(c).first(some);
      double* out = numbers.data() + begin * width_ + c;
      if (coded.shift[c] == kSteps) {
        const double step = step_of(coding_.bounds[c]);
        for (std::size_t r = 0; r < some; ++r)
          out[r * width_] = static_cast<double>(static_cast<std::int64_t>(values[r])) * step;
      } else {
        for (std::size_t r = 0; r < some; ++r) out[r * width_] = std::bit_cast<double>(values[r]);
      }
    }
  }
}

}  // namespace hapgrid
