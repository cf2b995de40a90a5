#include "libcore/check/model_check.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string>
#include <utility>

#include "libcore/base/random.hpp"
#include "libcore/base/text.hpp"
#include "libcore/check/singular.hpp"
#include "libcore/check/straight_way.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/model/room.hpp"

namespace hapgrid {

namespace {

using State = std::vector<double>;

// Of the spacing: small against what bends forces, large against rounding in energies.
constexpr double kDifferenceStep = 1e-3;
// Of the largest force: what a force may be off from the energy's gradient. A central difference
// over 2e-3 of the spacing is exact to some 1e-6; iterative models leave a residue.
constexpr double kForceTolerance = 0.02;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

CallTimes summary(std::vector<double> seconds) {
  CallTimes times;
  times.calls = seconds.size();
  if (seconds.empty()) return times;
  std::sort(seconds.begin(), seconds.end());
  const auto at = [&](double share) {
    return seconds[static_cast<std::size_t>(share * static_cast<double>(seconds.size() - 1))];
  };
  times.median = at(0.5);
  times.p99 = at(0.99);
  times.worst = seconds.back();
  times.mean =
      std::accumulate(seconds.begin(), seconds.end(), 0.0) / static_cast<double>(seconds.size());
  return times;
}

class ModelWalker {
 public:
  ModelWalker(const GridSpec& spec, const std::map<PointIndex, State>& seeds,
              const MakeModel& make_model, const ModelCheckLimits& limits)
      : spec_(spec),
        seeds_(seeds),
        limits_(limits),
        model_(make_model()),
        second_(make_model()),
        around_(spec.box),
        singular_(spec, *model_),
        random_(limits.walk_seed),
        reached_(spec.row_size()),
        other_(spec.row_size()) {}

  ModelCheck run() {
    const double start = now();
    std::uint64_t steps = 0;
    while (steps < limits_.conversions) {
      auto seed = seeds_.begin();
      std::advance(seed, static_cast<std::ptrdiff_t>(random_.below(seeds_.size())));
      point_ = seed->first;
      const std::size_t n = spec_.state_size;
      const std::size_t level = random_.below(seed->second.size() / n);
      state_.assign(seed->second.begin() + static_cast<std::ptrdiff_t>(level * n),
                    seed->second.begin() + static_cast<std::ptrdiff_t>((level + 1) * n));
      // A walk has several targets: the next leg starts where the last one ended.
      for (int leg = 0; leg < kLegs && steps < limits_.conversions; ++leg) {
        const auto target = static_cast<PointIndex>(random_.below(spec_.box.points()));
        while (point_ != target && steps < limits_.conversions) {
          if (steps > 0 && now() - start > limits_.seconds) return result();
          ++steps;
          if (!step(direction_to(spec_.box, point_, target))) leg = kLegs;
          if (leg == kLegs) break;
        }
      }
      if (spec_.box.points() == 1) break;
    }
    return result();
  }

 private:
  static constexpr int kLegs = 4;

  std::string here(int q) const {
    return describe(spec_.box, point_) + " direction " + std::to_string(q) + " from state " +
           state_text(state_);
  }

  bool same(const State& a, const State& b) const { return model_->equal(a.data(), b.data()); }

  /// Makes one step of the walk and all trials there. Answers whether the walk can go on.
  bool step(int q) {
    const Vec3 x = spec_.box.position(point_);
    const Vec3& d = around_.shift(q);
    ++defined_.counted;
    const double before = now();
    const bool converted = model_->convert(state_.data(), x, d, reached_.data());
    convert_seconds_.push_back(now() - before);
    if (!converted) {
      defined_.offend([&] { return here(q) + ": " + model_->error(); });
      return false;
    }
    const State arrived(reached_.begin(), reached_.begin() + spec_.state_size);
    const Vec3 there{x[0] + d[0], x[1] + d[1], x[2] + d[2]};

    // The same bits again, from this model, whatever it did in between, and from another one.
    const State row = reached_;
    for (Model* model : {second_.get(), model_.get()}) {
      ++deterministic_.counted;
      if (!model->convert(state_.data(), x, d, other_.data()) ||
          std::memcmp(other_.data(), row.data(), row.size() * sizeof(double)) != 0)
        deterministic_.offend([&] {
          return here(q) + ": " + state_text(arrived) + ", then " +
                 state_text(std::span(other_).first(spec_.state_size));
        });
    }

    ++stays_.counted;
    if (!convert(arrived, there, {0, 0, 0}, other_) || !same(other_, arrived))
      stays_.offend([&] {
        return describe(spec_.box, point_) + ": from " + state_text(arrived) + " to " +
               state_text(std::span(other_).first(spec_.state_size));
      });

    ++returns_.counted;
    if (!convert(arrived, there, {-d[0], -d[1], -d[2]}, other_) || !same(other_, state_))
      returns_.offend([&] {
        return here(q) + ": back in " + state_text(std::span(other_).first(spec_.state_size));
      });
    else
      singular_.pass(x, d, other_, row);
    singular_.visit(there, row);

    ++halves_.counted;
    const Vec3 half{d[0] / 2, d[1] / 2, d[2] / 2};
    const Vec3 middle{x[0] + half[0], x[1] + half[1], x[2] + half[2]};
    State halfway(spec_.row_size());
    if (!convert(state_, x, half, halfway) || !convert(halfway, middle, half, other_) ||
        !same(other_, arrived))
      halves_.offend([&] {
        return here(q) + ": at once " + state_text(arrived) + ", in two halves " +
               state_text(std::span(other_).first(spec_.state_size));
      });

    try_tolerance(arrived);
    try_force(there, arrived);
    point_ = static_cast<PointIndex>(std::int64_t{point_} + around_.offset(q));
    state_ = arrived;
    return true;
  }

  bool convert(const State& s, const Vec3& x, const Vec3& d, State& row) {
    return model_->convert(s.data(), x, d, row.data());
  }

  void try_tolerance(const State& arrived) {
    ++reflexive_.counted;
    if (!same(arrived, arrived)) reflexive_.offend([&] { return state_text(arrived); });
    ++symmetric_.counted;
    if (same(arrived, state_) != same(state_, arrived))
      symmetric_.offend([&] { return state_text(arrived) + " and " + state_text(state_); });
  }

  /// Force, energy and shape in `s` at x: finite, and the force the energy's gradient.
  void try_force(const Vec3& x, const State& s) {
    State row = s;
    row.resize(spec_.row_size());
    if (model_->has_shape() && !spec_.stored.shape) {
      std::vector<float> centres(std::size_t{3} * model_->info().spheres.size());
      const double before = now();
      model_->shape(s.data(), centres);
      shape_seconds_.push_back(now() - before);
      ++finite_.counted;
      if (!std::all_of(centres.begin(), centres.end(), [](float c) { return std::isfinite(c); }))
        finite_.offend([&] { return "shape in state " + state_text(s); });
    }
    if (!model_->has_force() && !spec_.stored.force) return;
    Vec3 force{};
    if (spec_.stored.force) {
      if (!model_->complete(x, row.data())) return;  // convert() has reported that
      std::copy_n(row.begin() + spec_.force_offset(), 3, force.begin());
    } else {
      const double before = now();
      force = model_->force(x, s.data());
      force_seconds_.push_back(now() - before);
    }
    ++finite_.counted;
    const double magnitude = std::hypot(force[0], force[1], force[2]);
    if (!std::isfinite(magnitude))
      return finite_.offend([&] { return "force in state " + state_text(s); });
    largest_force_ = std::max(largest_force_, magnitude);
    if (!model_->has_energy() && !spec_.stored.energy) return;

    try_gradient(x, s, row, force);
  }

  double energy_of(const Vec3& x, const State& row) const {
    return spec_.stored.energy ? row[spec_.energy_offset()] : model_->energy(x, row.data());
  }

  /// E of the state that the model takes on when the HIP moves a little: C of both sides, where
  /// both come back to s (no tear-off in between).
  void try_gradient(const Vec3& x, const State& s, State& row, const Vec3& force) {
    if (spec_.stored.energy && !spec_.stored.force && !model_->complete(x, row.data())) return;
    const double here = energy_of(x, row);
    const int axis = static_cast<int>(gradients_.size() % 3);
    const double e = kDifferenceStep * spec_.box.spacing;
    std::array<double, 2> slope{};  // before x and behind it
    for (int side = 0; side < 2; ++side) {
      Vec3 d{0, 0, 0};
      d[axis] = side ? e : -e;
      const Vec3 beside{x[0] + d[0], x[1] + d[1], x[2] + d[2]};
      State moved(spec_.row_size()), back(spec_.row_size());
      if (!convert(s, x, d, moved) || !convert(moved, beside, {-d[0], -d[1], -d[2]}, back) ||
          !same(back, s))
        return;
      slope[static_cast<std::size_t>(side)] = (energy_of(beside, moved) - here) / d[axis];
    }
    // Where the force changes much within the step, as before a tear-off, it is between the two.
    const double scale = -model_->info().force_scale;
    const auto [low, high] = std::minmax({scale * slope[0], scale * slope[1]});
    gradients_.push_back({force[axis], std::clamp(force[axis], low, high), x, axis});
  }

  /// What the model itself says against its parameters.
  void ask_model() {
    if (!model_->has_check()) return;
    for (const std::string& problem : model_->check()) sane_.offend([&] { return problem; });
    sane_.counted = std::max<std::uint64_t>(spec_.parameters.size(), sane_.offenders);
  }

  /// Whether the hand can pass the shape that the model has in its first seed. A shape that ends
  /// outside on one side is common: a rope or a block hangs on something.
  void look_for_room() {
    const auto& [point, states] = *seeds_.begin();
    const auto shape = extent_with_probe(*model_, spec_.box.position(point), states.data());
    if (!shape) return;
    const auto& n = spec_.box.counts;
    const Extent3 box{spec_.box.position(GridCoordinates{0, 0, 0}),
                      spec_.box.position(GridCoordinates{n[0] - 1, n[1] - 1, n[2] - 1})};
    room_.counted = 1;
    for (int a = 0; a < 3 && room_.offenders == 0; ++a)
      if (n[a] > 1 && shape->low[a] < box.low[a] && shape->high[a] > box.high[a])
        room_.offend(
            [&] { return "it reaches " + extent_text(*shape) + ", the box " + extent_text(box); });
  }

  /// Followed where nothing else is broken: what fails everywhere fails near a pole, too.
  Findings singular_places() {
    for (const Findings* broken : {&defined_, &deterministic_, &stays_, &finite_})
      if (broken->offenders > 0) return {};
    const auto seconds = std::chrono::duration<double>(limits_.seconds / 4);
    using Clock = std::chrono::steady_clock;
    return singular_.search(Clock::now() + std::chrono::duration_cast<Clock::duration>(seconds));
  }

  /// And the median of what the force is off.
  Findings compare_gradients(double& median_error) {
    Findings gradient;
    std::vector<double> errors;
    for (const Gradient& g : gradients_) {
      ++gradient.counted;
      const double error = std::abs(g.force - g.difference) / std::max(largest_force_, 1e-300);
      if (g.force != 0) errors.push_back(error);  // where nothing is felt all is well, and common
      if (!(error <= kForceTolerance))
        gradient.offend([&] {
          return std::string("at (") + to_text(g.x[0]) + ", " + to_text(g.x[1]) + ", " +
                 to_text(g.x[2]) + "): force " + "xyz"[g.axis] + " " + to_text(g.force) +
                 " N, the energy's gradient gives " + to_text(g.difference);
        });
    }
    if (errors.empty()) return gradient;
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    median_error = *middle;
    return gradient;
  }

  ModelCheck result() {
    ask_model();
    look_for_room();
    ModelCheck out;
    out.convert = summary(convert_seconds_);
    out.force = summary(force_seconds_);
    out.shape = summary(shape_seconds_);
    out.largest_force = largest_force_;
    const auto add = [&](const char* name, const char* unit, const char* meaning, Findings&& found,
                         bool note = false) {
      if (found.counted > 0) out.checks.push_back({name, unit, meaning, std::move(found), note});
    };
    Findings singular = singular_places();
    add("defined", "conversions", "steps of the grid that C fails on", std::move(defined_));
    add("deterministic", "conversions",
        "C, asked again, answers with other bits: no two runs will give the same grid",
        std::move(deterministic_));
    add("stays", "states",
        "C(s, x, 0) is another state than s: a state that was reached is not at rest",
        std::move(stays_));
    add("reflexive", "states", "the tolerance function says that a state differs from itself",
        std::move(reflexive_));
    add("symmetric", "pairs", "the tolerance function depends on the order of its arguments",
        std::move(symmetric_));
    add("finite", "calls", "force or shape that is not finite", std::move(finite_));
    add("gradient", "forces",
        "the force is not the energy's negative gradient: a loop of the hand would gain or lose "
        "energy",
        compare_gradients(out.median_force_error));
    add("sane", "parameters", "what the model itself says against its parameters",
        std::move(sane_));
    add("singular", "places", "force, energy or state grow without end, or the force jumps",
        std::move(singular));
    add("room", "shapes",
        "along an axis, the box ends inside the shape with the probe around it on both sides: the "
        "hand cannot pass it there",
        std::move(room_), true);
    add("halves", "conversions",
        "a step in two halves ends in another state: that is right near a tear-off; elsewhere C "
        "walks too coarsely",
        std::move(halves_), true);
    add("returns", "conversions",
        "a step there and back ends in another state: levels are there for such hysteresis; many "
        "of them mean that C is less exact than its tolerance",
        std::move(returns_), true);
    return out;
  }

  struct Gradient {
    double force, difference;
    Vec3 x;
    int axis;
  };

  const GridSpec& spec_;
  const std::map<PointIndex, State>& seeds_;
  ModelCheckLimits limits_;
  std::unique_ptr<Model> model_;
  std::unique_ptr<Model> second_;
  Neighbourhood around_;
  SingularPlaces singular_;
  SplitMix64 random_;
  PointIndex point_ = 0;
  State state_;
  State reached_;  // rows
  State other_;
  Findings defined_, deterministic_, stays_, returns_, halves_, reflexive_, symmetric_, finite_;
  Findings sane_, room_;
  std::vector<double> convert_seconds_, force_seconds_, shape_seconds_;
  std::vector<Gradient> gradients_;
  double largest_force_ = 0;
};

}  // namespace

ModelCheck check_model(const GridSpec& spec, const std::map<PointIndex, std::vector<double>>& seeds,
                       const MakeModel& make_model, const ModelCheckLimits& limits) {
  return ModelWalker(spec, seeds, make_model, limits).run();
}

}  // namespace hapgrid
