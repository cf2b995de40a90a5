#include "libcore/check/estimate.hpp"

#include <time.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "libcore/base/random.hpp"
#include "libcore/check/straight_way.hpp"
#include "libcore/search/bisection.hpp"
#include "libcore/shard/format.hpp"

namespace hapgrid {

namespace {

using State = std::vector<double>;

constexpr int kWays = 4;  // to each point
// What the search itself takes for a request, beside C: tests/bench/search.sh.
constexpr double kRequestSeconds = 20e-9;

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
        back_(spec.row_size()) {
    reached_.fill(State(spec.row_size()));
  }

  void run() {
    const double start = now();
    const auto is_time_over = [&] { return now() - start > limits_.seconds; };
    for (std::uint64_t n = 0; n < limits_.points && !is_time_over(); ++n) {
      const auto point = static_cast<PointIndex>(random_.below(spec_.box.points()));
      std::vector<State> found;
      for (int way = 0; way < kWays && (way == 0 || !is_time_over()); ++way)
        if (std::optional<State> row = go_to(point); row && is_new(found, *row))
          found.push_back(std::move(*row));
      if (found.empty()) continue;
      ++points_;
      records_ += static_cast<double>(found.size());
      for (const State& row : found) look_around(point, row);
    }
  }

  /// Of nothing, when no point was reached.
  std::optional<double> levels() const {
    return points_ > 0 ? std::optional(records_ / points_) : std::nullopt;
  }
  double seconds_a_conversion() const { return seconds_ / std::max(conversions_, 1.0); }
  /// Of the round of tear fractions, for a conversion of the others.
  double tear_share() const { return tear_conversions_ / std::max(conversions_, 1.0); }
  double tear_seconds_share() const { return tear_seconds_ / std::max(conversions_, 1.0); }

 private:
  /// Of a plug-in, of this thread alone: others may use the machine, too.
  double now() const {
    timespec time{};
    ::clock_gettime(model_.is_process() ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  bool is_new(const std::vector<State>& known, const State& row) const {
    return std::none_of(known.begin(), known.end(),
                        [&](const State& k) { return model_.equal(k.data(), row.data()); });
  }

  /// The state at a point, come by a random way.
  std::optional<State> go_to(PointIndex target) {
    auto seed = seeds_.begin();
    std::advance(seed, static_cast<std::ptrdiff_t>(random_.below(seeds_.size())));
    const std::size_t n = spec_.state_size;
    const auto level = static_cast<std::ptrdiff_t>(random_.below(seed->second.size() / n));
    const auto size = static_cast<std::ptrdiff_t>(n);
    State row(seed->second.begin() + level * size, seed->second.begin() + (level + 1) * size);
    row.resize(spec_.row_size());
    PointIndex here = seed->first;
    const auto past = static_cast<PointIndex>(random_.below(spec_.box.points()));
    for (const PointIndex to : {past, target})
      while (here != to) {
        const int q = direction_to(spec_.box, here, to);
        if (!model_.convert(row.data(), spec_.box.position(here), around_.shift(q), back_.data()))
          return std::nullopt;
        std::swap(row, back_);
        here = static_cast<PointIndex>(std::int64_t{here} + around_.offset(q));
      }
    return row;
  }

  void look_around(PointIndex point, const State& row) {
    const Vec3 x = spec_.box.position(point);
    const DirectionMask inside = around_.inside(point);
    const double start = now();
    for (DirectionMask left = inside; left; left &= left - 1) {
      const auto q = static_cast<std::size_t>(std::countr_zero(left));
      if (!model_.convert(row.data(), x, around_.shift(static_cast<int>(q)), reached_[q].data()))
        return;
    }
    seconds_ += now() - start;
    conversions_ += std::popcount(inside);
    if (!spec_.tears) return;
    DirectionMask one_way = 0;
    for (DirectionMask left = inside; left; left &= left - 1) {
      const auto q = static_cast<std::size_t>(std::countr_zero(left));
      const Vec3& d = around_.shift(static_cast<int>(q));
      if (!model_.convert(reached_[q].data(), {x[0] + d[0], x[1] + d[1], x[2] + d[2]},
                          {-d[0], -d[1], -d[2]}, back_.data()) ||
          !model_.equal(back_.data(), row.data()))
        one_way |= DirectionMask{1} << q;
    }
    const double torn = now();
    for (; one_way; one_way &= one_way - 1) {
      const auto q = static_cast<std::size_t>(std::countr_zero(one_way));
      bisection_.start(0, x, around_.shift(static_cast<int>(q)), row, reached_[q]);
      do {
        const Conversion c = bisection_.conversion(0);
        if (!model_.convert(c.s, c.x, c.d, c.row)) break;
        ++tear_conversions_;
      } while (!bisection_.advance(distance_));
    }
    tear_seconds_ += now() - torn;
  }

  const GridSpec& spec_;
  const std::map<PointIndex, State>& seeds_;
  Model& model_;
  const EstimateLimits& limits_;
  Neighbourhood around_;
  SplitMix64 random_;
  StateDistance distance_;
  Bisection bisection_;
  std::array<State, kDirections> reached_;
  State back_;
  double points_ = 0, records_ = 0, conversions_ = 0, seconds_ = 0;
  double tear_conversions_ = 0, tear_seconds_ = 0;
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
