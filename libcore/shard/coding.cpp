#include "libcore/shard/coding.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "libcore/base/error.hpp"
#include "libcore/shard/planes.hpp"

namespace hapgrid {

namespace {

constexpr unsigned kMaxShift = 52;  // the mantissa's bits

// Beyond, the rounding of multiple * step comes near the bound. It is checked in any case.
constexpr double kMaxMultiple = 1099511627776;  // 2^40

std::uint32_t zigzag(std::uint32_t v) { return v << 1 ^ (0 - (v >> 31)); }
std::uint32_t unzigzag(std::uint32_t z) { return z >> 1 ^ (0 - (z & 1)); }

/// How many of the lowest bits are 0 in each of the values; of floats at least 29.
unsigned common_shift(std::span<const double> values) {
  std::uint64_t all = 0;
  for (const double v : values) all |= std::bit_cast<std::uint64_t>(v);
  return std::min(kMaxShift, static_cast<unsigned>(std::countr_zero(all)));
}

/// The values as multiples of the step; false when one of them is then off by more than `bound`.
bool to_multiples(std::span<const double> values, double bound,
                  std::vector<std::uint64_t>& multiples) {
  const double step = step_of(bound);
  if (!(bound >= std::numeric_limits<double>::min()) || !std::isfinite(step)) return false;
  for (std::size_t r = 0; r < values.size(); ++r) {
    const double multiple = std::nearbyint(values[r] / step);
    // Written so that NaN is refused.
    if (!(std::abs(multiple) <= kMaxMultiple) || !(std::abs(multiple * step - values[r]) <= bound))
      return false;
    multiples[r] = static_cast<std::uint64_t>(static_cast<std::int64_t>(multiple));
  }
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
    differences_[r] = zigzag(rows.generation[r] - (r > 0 ? rows.generation[r - 1] : 0));
  coded_.generation.resize(4 * count);
  split_planes<std::uint32_t>(differences_, 4, coded_.generation.data());
  coded_.level.assign(rows.level.begin(), rows.level.end());
  coded_.links.assign(rows.links.begin(), rows.links.end());

  stencil_.find(rows.point, rows.level, rows.links, counts_);
  coded_.order.resize(width_);
  coded_.shift.resize(width_);
  coded_.planes.resize(width_);
  coded_.first.resize(8 * std::size_t{width_});
  coded_.residuals.clear();
  column_.resize(count);
  multiples_.resize(count);
  residuals_.resize(count);
  for (std::size_t c = 0; c < width_; ++c) {
    for (std::size_t r = 0; r < count; ++r) column_[r] = rows.numbers[r * width_ + c];
    encode_column(c, coding_.is_lossy() ? coding_.bounds[c] : 0);
  }
  return coded_;
}

void ChunkEncoder::encode_column(std::size_t c, double bound) {
  Orders orders;
  if (bound > 0 && to_multiples(column_, bound, multiples_)) {
    coded_.shift[c] = kSteps;
    orders = choose_orders(stencil_, std::span<const std::uint64_t>(multiples_));
    encode_integers(stencil_, orders, multiples_, residuals_, scratch_);
  } else {
    const unsigned shift = common_shift(column_);
    coded_.shift[c] = static_cast<std::uint8_t>(shift);
    orders = choose_orders(stencil_, shift, column_);
    encode_doubles(stencil_, orders, shift, column_, residuals_, scratch_);
  }
  coded_.order[c] = orders.packed();
  const std::uint64_t first =
      coded_.shift[c] == kSteps ? multiples_[0] : std::bit_cast<std::uint64_t>(column_[0]);
  std::memcpy(&coded_.first[8 * c], &first, sizeof first);
  const unsigned planes = planes_needed(std::span<const std::uint64_t>(residuals_));
  coded_.planes[c] = static_cast<std::uint8_t>(planes);
  const std::size_t begin = coded_.residuals.size();
  coded_.residuals.resize(begin + planes * residuals_.size());
  split_planes<std::uint64_t>(residuals_, planes, coded_.residuals.data() + begin);
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
  join_planes<PointIndex>(coded.point.data(), 4, rows.coded_point);
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
  join_planes<std::uint32_t>(coded.generation.data(), 4, rows.coded_generation);
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
  residuals_.resize(2 * count);
  const std::uint8_t* bytes = coded.residuals.data();
  std::size_t waiting = 0;  // of the two columns that are decoded together
  std::array<CodedDoubles, 2> doubles;
  for (std::size_t c = 0; c < width_; ++c) {
    const std::span<std::uint64_t> residuals =
        std::span(residuals_).subspan(waiting * count, count);
    join_planes<std::uint64_t>(bytes, coded.planes[c], residuals);
    bytes += coded.planes[c] * count;
    const Orders orders = Orders::unpacked(coded.order[c]);
    double* const numbers = rows.transposed.data() + c;
    std::uint64_t first = 0;
    std::memcpy(&first, &coded.first[8 * c], sizeof first);
    if (coded.shift[c] == kSteps) {
      decode_integers(stencil_, orders, step_of(coding_.bounds[c]), first, residuals, numbers,
                      width_, scratch_);
      continue;
    }
    doubles[waiting++] = {orders, coded.shift[c], std::bit_cast<double>(first), residuals.data(),
                          numbers};
    if (waiting < doubles.size()) continue;
    decode_doubles(stencil_, doubles, width_, scratch_);
    waiting = 0;
  }
  decode_doubles(stencil_, std::span(doubles).first(waiting), width_, scratch_);
  for (std::size_t c = shape_offset_; c < width_; ++c)
    for (std::size_t r = 0; r < count; ++r) {
      const double v = std::abs(rows.transposed[r * width_ + c]);
      if (std::isfinite(v) && v > std::numeric_limits<float>::max())
        throw FormatError("damaged: a shape with a number beyond any float");
    }
}

}  // namespace hapgrid
