#include "libcore/check/estimate.hpp"

#include <time.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include "libcore/base/random.hpp"
#include "libcore/check/straight_way.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/search/bisection.hpp"
#include "libcore/shard/format.hpp"

namespace hapgrid {

namespace {

using State = std::vector<double>;

// What the search itself takes for a request, beside C: tests/bench/search.sh.
constexpr double kRequestSeconds = 20e-9;
constexpr std::uint32_t kFewestPoints = 4;  // along the longest side of the first box
constexpr double kFiner = 0.7;              // the stride of the next box, for that of the last one
// A conversion of a bisection goes half a step or less.
constexpr double kBisectionStep = 0.5;
constexpr double kSearchShare = 0.75;  // of the time; the rest is for looking around

/// Every so many points along each axis, as a box of its own.
struct CoarseBox {
  CoarseBox(const Box& fine, std::uint32_t stride) : stride(stride), box(fine) {
    box.spacing *= stride;
    for (int a = 0; a < 3; ++a) {
      box.counts[a] = (fine.counts[a] - 1) / stride + 1;
      first[a] = (fine.counts[a] - 1) % stride / 2;
    }
    box.origin = fine.position(first);
  }
  GridCoordinates fine(PointIndex p) const {
    GridCoordinates c = box.coordinates(p);
    for (int a = 0; a < 3; ++a) c[a] = first[a] + c[a] * stride;
    return c;
  }
  GridCoordinates nearest(const GridCoordinates& fine) const {
    GridCoordinates c{};
    for (int a = 0; a < 3; ++a)
      c[a] = std::min((std::max(fine[a], first[a]) - first[a] + stride / 2) / stride,
                      box.counts[a] - 1);
    return c;
  }

  std::uint32_t stride;
  GridCoordinates first{};
  Box box;
};

class Sampler {
 public:
  Sampler(const GridSpec& spec, const std::map<PointIndex, State>& seeds, Model& model,
          const EstimateLimits& limits)
      : spec_(spec),
        seeds_(seeds),
        model_(model),
        limits_(limits),
        around_(spec.box),
        random_(limits.seed),
        distance_(spec, [&model](const double* a, const double* b) { return model.equal(a, b); }),
        bisection_(spec.row_size()),
        reached_(spec.row_size()),
        back_(spec.row_size()),
        start_(now()),
        coarse_(spec.box, 1) {}

  void run() {
    std::uint32_t stride = coarsest();
    for (double took = 0; search(CoarseBox(spec_.box, stride), took) && stride > 1;) {
      const auto finer = std::min(stride - 1, static_cast<std::uint32_t>(stride * kFiner + 1));
      const double ratio = stride / static_cast<double>(finer);
      // A model that walks in substeps takes less time for a shorter step.
      if (passed() + took * ratio * ratio > kSearchShare * limits_.seconds) break;
      stride = finer;
    }
    look_around();
  }

  /// Of nothing, when no record was looked at.
  std::optional<double> levels() const {
    if (sum_.records == 0) return std::nullopt;
    return static_cast<double>(records_.size()) / points_;
  }
  double seconds_a_conversion() const { return sum_.seconds / std::max(sum_.conversions, 1.0); }
  /// Of the round of tear fractions, for a conversion of the others.
  double tear_share() const { return sum_.tear_conversions / std::max(sum_.conversions, 1.0); }
  double tear_seconds_share() const { return sum_.tear_seconds / std::max(sum_.conversions, 1.0); }

 private:
  struct Record {
    PointIndex at;     // of the coarse box
    PointIndex point;  // of spec_.box
    State row;
  };
  /// What the records cost that were looked at.
  struct Cost {
    double records = 0, conversions = 0, seconds = 0, tear_conversions = 0, tear_seconds = 0;
  };

  /// Of a plug-in, of this thread alone: others may use the machine, too.
  double now() const {
    timespec time{};
    ::clock_gettime(model_.is_process() ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double passed() const { return now() - start_; }

  /// The stride with kFewestPoints, or a shorter one whose steps the model can convert.
  std::uint32_t coarsest() const {
    const auto& counts = spec_.box.counts;
    const std::uint32_t longest = *std::max_element(counts.begin(), counts.end());
    const double most = std::floor(model_.info().d_max / (std::sqrt(3.0) * spec_.box.spacing));
    const std::uint32_t wanted = (longest - 1) / (kFewestPoints - 1);
    return std::max(1U, static_cast<std::uint32_t>(std::min<double>(wanted, most)));
  }

  /// The search of the method, in a coarse box. False when it was not finished in time; what it
  /// found stands for the grid nevertheless.
  bool search(const CoarseBox& coarse, double& took) {
    const double begin = passed();
    const auto is_over = [&] { return passed() > kSearchShare * limits_.seconds; };
    const Neighbourhood around(coarse.box);
    std::vector<std::vector<State>> levels(coarse.box.points());
    std::vector<std::pair<PointIndex, std::size_t>> frontier;
    const auto add = [&](PointIndex p, const State& row) {
      if (levels[p].size() >= spec_.max_levels) return;
      for (const State& known : levels[p])
        if (model_.equal(known.data(), row.data())) return;
      levels[p].push_back(row);
      frontier.emplace_back(p, levels[p].size() - 1);
    };
    for (const auto& [point, states] : seeds_)
      for (std::size_t at = 0; at < states.size(); at += spec_.state_size) {
        const auto from = states.begin() + static_cast<std::ptrdiff_t>(at);
        State row(from, from + spec_.state_size);
        row.resize(spec_.row_size());
        const PointIndex p = coarse.box.index(coarse.nearest(spec_.box.coordinates(point)));
        if (go(row, point, spec_.box.index(coarse.fine(p)))) add(p, row);
      }
    State reached(spec_.row_size());
    for (std::size_t i = 0; i < frontier.size() && !is_over(); ++i) {
      const auto [p, level] = frontier[i];
      const State row = levels[p][level];
      const Vec3 x = spec_.box.position(coarse.fine(p));
      for (DirectionMask left = around.inside(p); left; left &= left - 1) {
        const int q = std::countr_zero(left);
        if (model_.convert(row.data(), x, around.shift(q), reached.data()))
          add(static_cast<PointIndex>(std::int64_t{p} + around.offset(q)), reached);
      }
    }
    took = passed() - begin;
    const bool is_whole = !is_over();
    if (!is_whole && points_ > 0) return false;  // the coarser box was searched to its end
    coarse_ = coarse;
    records_.clear();
    points_ = 0;
    for (PointIndex p = 0; p < coarse.box.points(); ++p) {
      points_ += !levels[p].empty();
      for (State& row : levels[p])
        records_.push_back({p, spec_.box.index(coarse.fine(p)), std::move(row)});
    }
    return is_whole;
  }

  /// Straight on along the grid. False where the model fails.
  bool go(State& row, PointIndex here, PointIndex to) {
    while (here != to) {
      const int q = direction_to(spec_.box, here, to);
      if (!model_.convert(row.data(), spec_.box.position(here), around_.shift(q), back_.data()))
        return false;
      std::swap(row, back_);
      here = static_cast<PointIndex>(std::int64_t{here} + around_.offset(q));
    }
    return true;
  }

  /// Looks around the records in a random order while there is time; around one of them at least.
  void look_around() {
    std::vector<std::size_t> order(records_.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::size_t j = random_.below(i + 1);
      order[i] = order[j];
      order[j] = i;
    }
    for (const std::size_t i : order) {
      look_around(records_[i]);
      if (passed() > limits_.seconds) break;
    }
  }

  /// Times the conversions that the grid makes of a record. The bisections are counted in the
  /// coarse box: one link crosses fewer tears in a finer grid, but such a grid finds more levels,
  /// whose links are mostly one-way. On molecules the two come to much the same (slow/estimate.sh).
  void look_around(const Record& record) {
    const Vec3 x = spec_.box.position(record.point);
    const DirectionMask inside = around_.inside(record.point);
    const double begin = now();
    for (DirectionMask left = inside; left; left &= left - 1)
      if (!model_.convert(record.row.data(), x, around_.shift(std::countr_zero(left)),
                          back_.data()))
        return;
    const double seconds = now() - begin;
    const double tears = spec_.tears ? tear_conversions(record) : 0;
    sum_.records += 1;
    sum_.conversions += std::popcount(inside);
    sum_.seconds += seconds;
    if (tears == 0) return;
    sum_.tear_conversions += tears;
    sum_.tear_seconds += kBisectionStep * tears * seconds / std::popcount(inside);
  }

  double tear_conversions(const Record& record) {
    const Neighbourhood around(coarse_.box);
    const Vec3 x = spec_.box.position(record.point);
    double count = 0;
    for (DirectionMask left = around.inside(record.at); left; left &= left - 1) {
      const Vec3& d = around.shift(std::countr_zero(left));
      if (!model_.convert(record.row.data(), x, d, reached_.data())) continue;
      const bool is_there = model_.convert(reached_.data(), {x[0] + d[0], x[1] + d[1], x[2] + d[2]},
                                           {-d[0], -d[1], -d[2]}, back_.data());
      if (is_there && model_.equal(back_.data(), record.row.data())) continue;
      bisection_.start(0, x, d, record.row, reached_);
      do {
        const Conversion c = bisection_.conversion(0);
        if (!model_.convert(c.s, c.x, c.d, c.row)) break;
        ++count;
      } while (!bisection_.advance(distance_));
    }
    return count;
  }

  const GridSpec& spec_;
  const std::map<PointIndex, State>& seeds_;
  Model& model_;
  const EstimateLimits& limits_;
  Neighbourhood around_;
  SplitMix64 random_;
  StateDistance distance_;
  Bisection bisection_;
  State reached_, back_;
  double start_;
  CoarseBox coarse_;
  std::vector<Record> records_;  // of the coarse box, by point
  double points_ = 0;            // of it that were reached
  Cost sum_;
};

}  // namespace

GridEstimate estimate_grid(const GridSpec& spec, const std::map<PointIndex, State>& seeds,
                           Model& model, const EstimateLimits& limits,
                           double seconds_a_conversion) {
  Sampler sample(spec, seeds, model, limits);
  sample.run();
  GridEstimate estimate;
  if (sample.levels()) {
    estimate.levels = *sample.levels();
    seconds_a_conversion = sample.seconds_a_conversion();
  }
  // Pairs of neighbours: along each axis n - 1 to each side and n in place, less the points.
  std::uint64_t pairs = 1;
  for (const std::uint32_t count : spec.box.counts) pairs *= 3 * std::uint64_t{count} - 2;
  const double conversions = estimate.levels * static_cast<double>(pairs - spec.box.points());
  const auto whole = [](double x) { return static_cast<std::uint64_t>(std::llround(x)); };
  estimate.conversions = whole(conversions);
  estimate.tear_conversions = whole(sample.tear_share() * conversions);
  estimate.cpu_seconds =
      conversions * (seconds_a_conversion + kRequestSeconds + sample.tear_seconds_share());
  estimate.play_bytes = whole(
      estimate.levels * static_cast<double>(spec.box.points() * record_bytes(spec.row_size())) +
      static_cast<double>(spec.box.points() * sizeof(RecordIndex)));
  const auto slices = static_cast<std::uint64_t>(2 * Neighbourhood(spec.box).reach());
  estimate.expand_bytes = std::min(spec.box.points(), slices) * kDirections * sizeof(double) *
                          std::uint64_t{spec.row_size()};
  return estimate;
}

}  // namespace hapgrid
