#include "libcore/shard/finish.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libcore/shard/merged_rows.hpp"

namespace hapgrid {

namespace {

template <class Use>
void for_each_run(const std::vector<Section>& grid, Use&& use) {
  MergedRows<RecordRows> merged(grid);
  for (Run<RecordRows> run = merged.next(); run.rows; run = merged.next())
    use(*run.rows, run.begin, run.end);
}

}  // namespace

Coding final_coding(const std::vector<Section>& grid, double precision) {
  Coding coding{true, precision, {}};
  if (!coding.is_lossy()) return coding;
  const std::uint32_t width = row_size(grid.front().header);
  std::vector<double> least(width, std::numeric_limits<double>::infinity());
  std::vector<double> most(width, -std::numeric_limits<double>::infinity());
  for_each_run(grid, [&](const RecordRows& rows, std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      for (std::uint32_t c = 0; c < width; ++c) {
        const double v = rows.row(r)[c];
        if (!std::isfinite(v)) continue;
        least[c] = std::min(least[c], v);
        most[c] = std::max(most[c], v);
      }
    }
  });
  coding.bounds.resize(width);
  for (std::uint32_t c = 0; c < width; ++c) {
    const double bound = precision * (most[c] - least[c]);
    coding.bounds[c] = std::isfinite(bound) && bound > 0 ? bound : 0;
  }
  return coding;
}

void copy_records(const std::vector<Section>& grid, SectionWriter& out) {
  for_each_run(grid, [&](const RecordRows& rows, std::size_t begin, std::size_t end) {
    out.records(rows, begin, end);
  });
  out.finish();
}

}  // namespace hapgrid
