#include "tools/check-model/estimate.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/grid/box.hpp"
#include "libcore/search/complete.hpp"
#include "libcore/search/converter.hpp"
#include "libcore/search/seed.hpp"
#include "libcore/shard/section.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

namespace {

using Clock = std::chrono::steady_clock;

// What the search itself takes for a request, beside C: tests/bench/search.sh.
constexpr double kRequestSeconds = 20e-9;
constexpr std::uint32_t kFewestPoints = 4;  // along the longest side of the first box
constexpr double kFiner = 0.7;              // the stride of the next box, for that of the last one
// What a single coarse grid may be wrong by: tests/cli/check-model/slow/estimate.sh.
constexpr double kUnknownFactor = 3;
constexpr double kRuleOfThree = 3;

/// Sets `stop` at a time, unless it is destroyed before. All that needs memory is made by who makes
/// it: the thread itself could tell nobody that there is none.
class Alarm {
 public:
  Alarm(std::atomic<int>& stop, Clock::time_point when)
      : thread_([this, &stop, when](const std::stop_token& cancelled) {
          std::unique_lock lock(mutex_);
          wake_.wait_until(lock, cancelled, when, [] { return false; });
          if (!cancelled.stop_requested()) stop = 1;
        }) {}

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

/// The stride with kFewestPoints, or a shorter one whose steps the model can convert.
std::uint32_t coarsest(const Box& box, double d_max) {
  const std::uint32_t longest = *std::max_element(box.counts.begin(), box.counts.end());
  const double most = std::floor(d_max / (std::sqrt(3.0) * box.spacing));
  const std::uint32_t wanted = (longest - 1) / (kFewestPoints - 1);
  return std::max(1U, static_cast<std::uint32_t>(std::min<double>(wanted, most)));
}

/// Every stride-th point along each axis, in the middle of the box.
Box coarse_box(const Box& fine, std::uint32_t stride) {
  Box box = fine;
  GridCoordinates first{};
  for (int a = 0; a < 3; ++a) {
    box.counts[a] = (fine.counts[a] - 1) / stride + 1;
    first[a] = (fine.counts[a] - 1) % stride / 2;
  }
  box.spacing *= stride;
  box.origin = fine.position(first);
  return box;
}

PointIndex nearest_point(const Box& box, const Vec3& x) {
  GridCoordinates c{};
  for (int a = 0; a < 3; ++a)
    c[a] = static_cast<std::uint32_t>(
        std::clamp(std::round((x[a] - box.origin[a]) / box.spacing), 0.0, box.counts[a] - 1.0));
  return box.index(c);
}

/// The same grid with fewer points. The states of a seed are carried on to the nearest point, which
/// is within d_max.
Definition coarser(const Definition& fine, const Seeds& seeds, std::uint32_t stride, Model& model) {
  Definition coarse = fine;
  coarse.box = coarse_box(fine.box, stride);
  const std::size_t n = model.state_size();
  std::map<PointIndex, std::vector<std::vector<double>>> found;
  std::vector<double> row(model.row_size());
  for (const auto& [point, states] : seeds) {
    const Vec3 x = fine.box.position(point);
    const PointIndex to = nearest_point(coarse.box, x);
    const Vec3 y = coarse.box.position(to);
    std::vector<std::vector<double>>& there = found[to];
    for (std::size_t at = 0; at < states.size(); at += n) {
      if (!model.convert(&states[at], x, {y[0] - x[0], y[1] - x[1], y[2] - x[2]}, row.data()))
        throw ModelError(model.error());
      const auto is_same = [&](const std::vector<double>& s) {
        return model.equal(s.data(), row.data());
      };
      if (std::none_of(there.begin(), there.end(), is_same))
        there.emplace_back(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(n));
    }
  }
  coarse.seeds.clear();
  for (auto& [point, states] : found)
    coarse.seeds.push_back({coarse.box.position(point), std::move(states)});
  return coarse;
}

FileDescriptor memory_file() {
  FileDescriptor file(::memfd_create("grid", MFD_CLOEXEC));
  if (!file) throw std::system_error(errno, std::generic_category(), "memory for an estimate");
  return file;
}
std::string name_of(const FileDescriptor& file) { return format("/proc/self/fd/{}", file.get()); }

/// What one search has found.
struct Found {
  double levels = 1;  ///< of a point
  std::uint64_t points = 0, conversions = 0;
  bool is_whole = true;  ///< it has come to its end
};

double count(std::uint64_t n) { return static_cast<double>(n); }

/// Searches a grid from its seeds until its end, or until `end`.
Found search(const Definition& definition, std::unique_ptr<Model>& model, Clock::time_point end) {
  const GridSpec spec = spec_of(definition, *model);
  const FileDescriptor seeds = memory_file(), grid = memory_file();
  SectionWriter seed_writer(seeds.get(), name_of(seeds), {Content::kGrid, 0, spec});
  write_seeds(definition, spec, *model, seed_writer);
  std::atomic<int> stop{0};
  Progress progress;
  progress.stop = &stop;
  Converter converter(std::move(model), spec, progress);
  Found found;
  try {
    const Alarm alarm(stop, end);
    complete(open_grid(name_of(seeds)), converter, progress, [&](const SectionHeader& header) {
      return SectionWriter(grid.get(), name_of(grid), header);
    });
  } catch (const Stopped&) {
    found.is_whole = false;
  }
  model = converter.take_model();
  found.points = spec.box.points();
  found.conversions = progress.conversions;
  found.levels = std::max(1.0, count(progress.records) / count(found.points));
  return found;
}

/// The last of a series of searches, and between how many levels a point most likely has.
struct Series {
  Found last;
  Range levels;
  std::uint64_t conversions = 0;  ///< of all
};

/// Searches finer and finer grids.
Series search_all(const Definition& definition, std::unique_ptr<Model>& model, double seconds) {
  const Seeds seeds = seed_states(definition, *model);  // a process has started then
  const auto begin = Clock::now();
  const auto end =
      begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  std::uint32_t stride = coarsest(definition.box, model->info().d_max);
  Series series;
  const auto search_next = [&] {
    const Found found = search(coarser(definition, seeds, stride, *model), model, end);
    series.conversions += found.conversions;
    return found;
  };
  series.last = search_next();
  if (!series.last.is_whole)
    throw Error(
        format("too few steps: {} conversions in {:.0f} s are not the end of the search of a "
               "coarser grid, "
               "of {} points. --seconds gives it more time",
               series.last.conversions, seconds, series.last.points));
  double changed = kUnknownFactor - 1;
  while (stride > 1 && Clock::now() < end) {
    stride = std::min(stride - 1, static_cast<std::uint32_t>(stride * kFiner + 1));
    const Found finer = search_next();
    if (!finer.is_whole) break;
    changed = 2 * std::abs(finer.levels / series.last.levels - 1);
    series.last = finer;
  }
  const Found& last = series.last;
  const bool is_all = last.points == definition.box.points();
  if (is_all) changed = 0;  // that was the grid itself
  // Where no more levels were seen at n points, at most 3 in n have some (95 %).
  const double open = is_all ? 0 : kRuleOfThree / count(last.points);
  const double most = last.levels * (1 + changed + open);
  series.levels = {last.levels, std::max(1.0, last.levels / (1 + changed + open)), most};
  return series;
}

}  // namespace

GridEstimate estimate_grid(const Definition& definition, const ModelSource& source, double seconds,
                           const Range& conversion) {
  std::unique_ptr<Model> model = source.create(definition.parameters, definition.store);
  const Series series = search_all(definition, model, seconds);
  const double levels = series.levels.value;
  const Box& box = definition.box;
  GridEstimate estimate;
  estimate.levels = series.levels;
  estimate.points = series.last.points;
  estimate.searched = series.conversions;
  // Pairs of neighbours: along each axis n - 1 to each side and n in place, less the points.
  std::uint64_t pairs = 1;
  for (const std::uint32_t n : box.counts) pairs *= 3 * std::uint64_t{n} - 2;
  const double conversions = levels * count(pairs - box.points());
  const auto whole = [](double x) { return static_cast<std::uint64_t>(std::llround(x)); };
  estimate.conversions = whole(conversions);
  const auto cost = [&](double of_levels, double of_one) {
    return of_levels / levels * conversions * (of_one + kRequestSeconds);
  };
  estimate.cpu_seconds = {cost(levels, conversion.value),
                          cost(series.levels.least, conversion.least),
                          cost(series.levels.most, conversion.most)};
  const std::uint32_t width = model->row_size();
  estimate.play_bytes = whole(levels * count(box.points() * record_bytes(width)) +
                              count(box.points() * sizeof(RecordIndex)));
  const auto slices = static_cast<std::uint64_t>(2 * Neighbourhood(box).reach());
  estimate.expand_bytes =
      std::min(box.points(), slices) * kDirections * sizeof(double) * std::uint64_t{width};
  return estimate;
}

}  // namespace hapgrid
