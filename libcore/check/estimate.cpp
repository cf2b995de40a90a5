#include "libcore/check/estimate.hpp"

#include <time.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <optional>

#include "libcore/base/random.hpp"
#include "libcore/check/straight_way.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/search/bisection.hpp"
#include "libcore/shard/format.hpp"

namespace hapgrid {

namespace {

using State = std::vector<double>;

constexpr unsigned kCalmShare = 8;
constexpr int kWays = 3;                 // to each point, from seeds
constexpr int kLoops = 8;                // from there to points nearby, and back
constexpr int kNear = 8;                 // as many steps away, at most, along each axis
constexpr std::size_t kMostLevels = 16;  // of a point that are looked at
constexpr double kMostUnseen = 5;        // levels that were not met, for one that was met once
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
      std::vector<Found> found;
      const Add add = [&](std::optional<State> row) {
        if (!row) return;
        for (Found& known : found)
          if (model_.equal(known.row.data(), row->data())) {
            ++known.times;
            return;
          }
        found.push_back({std::move(*row), 1, found.empty()});
      };
      add(come_from_seed(point));
      if (found.empty()) continue;
      ++points_;
      // Far from everything there is one state, as a rule: most such places are passed over, and
      // the others stand for them.
      double weight = 1;
      if (is_calm(point, found.front().row)) {
        look_around(point, found.front(), 1, nullptr);
        if (random_.below(kCalmShare) != 0) continue;
        weight = kCalmShare;
      }
      for (int way = 1; way < kWays && !is_time_over(); ++way) add(come_from_seed(point));
      for (int loop = 0; loop < kLoops && !is_time_over(); ++loop)
        add(go(found[random_.below(found.size())].row, point,
               {point_near(point), point_near(point), point}));
      // A conversion that does not lead back leads to another level, which may be new.
      for (std::size_t i = weight == 1 ? 0 : 1; i < found.size() && i < kMostLevels; ++i) {
        const Found one = found[i];
        look_around(point, one, weight, &add);
      }
    }
    add_unseen();
  }

  /// Of nothing, when no point was reached.
  std::optional<double> levels() const {
    return points_ > 0 ? std::optional(all_.records / points_) : std::nullopt;
  }
  double seconds_a_conversion() const { return all_.seconds / std::max(all_.conversions, 1.0); }
  /// Of the round of tear fractions, for a conversion of the others.
  double tear_share() const { return all_.tear_conversions / std::max(all_.conversions, 1.0); }
  double tear_seconds_share() const { return all_.tear_seconds / std::max(all_.conversions, 1.0); }

 private:
  /// Of a plug-in, of this thread alone: others may use the machine, too.
  double now() const {
    timespec time{};
    ::clock_gettime(model_.is_process() ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  struct Found {
    State row;
    int times = 0;
    bool is_first = false;  // the point's first one, which any way finds
  };
  /// What records cost, together.
  struct Cost {
    double records = 0, conversions = 0, seconds = 0, tear_conversions = 0, tear_seconds = 0;
    void add(const Cost& other, double factor = 1) {
      records += factor * other.records;
      conversions += factor * other.conversions;
      seconds += factor * other.seconds;
      tear_conversions += factor * other.tear_conversions;
      tear_seconds += factor * other.tear_seconds;
    }
  };

  using Add = std::function<void(std::optional<State>)>;

  /// As many levels as were not met at all, which are like those that were met once.
  /// Source: A. Chao, Scand. J. Statist. 11 (1984) 265, with the correction for a small f2.
  void add_unseen() {
    const double f1 = once_.records;
    if (f1 < 1) return;
    const double unseen = f1 * (f1 - 1) / (2 * (twice_ + 1));
    all_.add(once_, std::min(unseen / f1, kMostUnseen));
  }

  /// The state at a point, come by a random way.
  std::optional<State> come_from_seed(PointIndex target) {
    auto seed = seeds_.begin();
    std::advance(seed, static_cast<std::ptrdiff_t>(random_.below(seeds_.size())));
    const std::size_t n = spec_.state_size;
    const auto level = static_cast<std::ptrdiff_t>(random_.below(seed->second.size() / n));
    const auto size = static_cast<std::ptrdiff_t>(n);
    State row(seed->second.begin() + level * size, seed->second.begin() + (level + 1) * size);
    row.resize(spec_.row_size());
    const auto past = static_cast<PointIndex>(random_.below(spec_.box.points()));
    return go(std::move(row), seed->first, {past, target});
  }

  PointIndex point_near(PointIndex point) {
    GridCoordinates c = spec_.box.coordinates(point);
    for (int a = 0; a < 3; ++a) {
      const auto to =
          std::int64_t{c[a]} + static_cast<std::int64_t>(random_.below(2 * kNear + 1)) - kNear;
      c[a] = static_cast<std::uint32_t>(
          std::clamp<std::int64_t>(to, 0, std::int64_t{spec_.box.counts[a]} - 1));
    }
    return spec_.box.index(c);
  }

  /// The state at the last of these points, from one at `here`.
  std::optional<State> go(State row, PointIndex here, std::initializer_list<PointIndex> targets) {
    for (const PointIndex to : targets)
      while (here != to) {
        const int q = direction_to(spec_.box, here, to);
        if (!model_.convert(row.data(), spec_.box.position(here), around_.shift(q), back_.data()))
          return std::nullopt;
        std::swap(row, back_);
        here = static_cast<PointIndex>(std::int64_t{here} + around_.offset(q));
      }
    return row;
  }

  /// Whether the model is the same at all neighbours.
  bool is_calm(PointIndex point, const State& row) {
    const Vec3 x = spec_.box.position(point);
    for (DirectionMask left = around_.inside(point); left; left &= left - 1)
      if (!model_.convert(row.data(), x, around_.shift(std::countr_zero(left)), back_.data()) ||
          !model_.equal(back_.data(), row.data()))
        return false;
    return true;
  }

  /// @param weight how many records this one stands for
  void look_around(PointIndex point, const Found& found, double weight, const Add* add) {
    const State& row = found.row;
    const Vec3 x = spec_.box.position(point);
    const DirectionMask inside = around_.inside(point);
    Cost cost{1, static_cast<double>(std::popcount(inside))};
    const double start = now();
    for (DirectionMask left = inside; left; left &= left - 1) {
      const auto q = static_cast<std::size_t>(std::countr_zero(left));
      if (!model_.convert(row.data(), x, around_.shift(static_cast<int>(q)), reached_[q].data()))
        return;
    }
    cost.seconds = now() - start;
    const DirectionMask torn = one_way(x, row, inside, add);
    if (spec_.tears) bisect(x, row, torn, cost);
    all_.add(cost, weight);
    if (found.times == 1 && !found.is_first) once_.add(cost, weight);
    if (found.times == 2) twice_ += weight;
  }

  /// The directions whose conversion, which is in reached_, does not lead back.
  DirectionMask one_way(const Vec3& x, const State& row, DirectionMask inside, const Add* add) {
    DirectionMask found = 0;
    for (DirectionMask left = inside; left; left &= left - 1) {
      const auto q = static_cast<std::size_t>(std::countr_zero(left));
      const Vec3& d = around_.shift(static_cast<int>(q));
      const bool is_there =
          model_.convert(reached_[q].data(), {x[0] + d[0], x[1] + d[1], x[2] + d[2]},
                         {-d[0], -d[1], -d[2]}, back_.data());
      if (is_there && model_.equal(back_.data(), row.data())) continue;
      found |= DirectionMask{1} << q;
      if (is_there && add) (*add)(back_);
    }
    return found;
  }

  void bisect(const Vec3& x, const State& row, DirectionMask directions, Cost& cost) {
    const double start = now();
    for (; directions; directions &= directions - 1) {
      const auto q = static_cast<std::size_t>(std::countr_zero(directions));
      bisection_.start(0, x, around_.shift(static_cast<int>(q)), row, reached_[q]);
      do {
        const Conversion c = bisection_.conversion(0);
        if (!model_.convert(c.s, c.x, c.d, c.row)) break;
        ++cost.tear_conversions;
      } while (!bisection_.advance(distance_));
    }
    cost.tear_seconds = now() - start;
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
  double points_ = 0;
  Cost all_, once_;   // of all records that were met, and of those that were met once
  double twice_ = 0;  // how many were met twice
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
