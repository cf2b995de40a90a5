#include "libcore/check/model_check.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string>
#include <utility>

#include "libcore/base/format.hpp"
#include "libcore/base/random.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/grid/direction.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/model/fields.hpp"

namespace hapgrid {

namespace {

using State = std::vector<double>;

// Of the spacing: small against what bends forces, large against rounding in energies.
constexpr double kDifferenceStep = 1e-3;
// Of the largest force: what a force may be off from the energy's gradient. A central difference
// over 2e-3 of the spacing is exact to some 1e-6; iterative models leave a residue.
constexpr double kForceTolerance = 0.02;

constexpr std::uint64_t kWalkSeed = 1;

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

/// The direction of the next step from one grid point straight to another; the points differ.
int direction_to(const Box& box, PointIndex from, PointIndex to) {
  const GridCoordinates a = box.coordinates(from), b = box.coordinates(to);
  int d[3];
  for (int i = 0; i < 3; ++i) d[i] = b[i] > a[i] ? 1 : b[i] < a[i] ? -1 : 0;
  return Direction::of(d[0], d[1], d[2]).q();
}

class ModelWalker {
 public:
  ModelWalker(const GridSpec& spec, const std::map<PointIndex, State>& seeds,
              const MakeModel& make_model, std::uint64_t most_steps, double most_seconds)
      : spec_(spec),
        seeds_(seeds),
        most_steps_(most_steps),
        most_seconds_(most_seconds),
        model_(make_model()),
        second_(make_model()),
        fields_(spec, *model_),
        is_stored_(spec.row_size() > spec.state_size),
        around_(spec.box),
        random_(kWalkSeed),
        other_(spec.row_size()) {}

  ModelCheck run() {
    const double start = now();
    std::uint64_t steps = 0;
    while (steps < most_steps_) {
      auto seed = seeds_.begin();
      std::advance(seed, static_cast<std::ptrdiff_t>(random_.below(seeds_.size())));
      point_ = seed->first;
      const std::size_t n = spec_.state_size;
      const std::size_t level = random_.below(seed->second.size() / n);
      state_.assign(seed->second.begin() + static_cast<std::ptrdiff_t>(level * n),
                    seed->second.begin() + static_cast<std::ptrdiff_t>((level + 1) * n));
      // A walk has several targets: the next leg starts where the last one ended.
      for (int leg = 0; leg < kLegs && steps < most_steps_; ++leg) {
        const auto target = static_cast<PointIndex>(random_.below(spec_.box.points()));
        while (point_ != target && steps < most_steps_) {
          if (steps > 0 && now() - start > most_seconds_) return result();
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

  /// A step of a walk: C has carried on `from` at x by d.
  struct Step {
    PointIndex point;
    int q;
    Vec3 x, d, there;
    State from;
    State row;      ///< what C has given
    State arrived;  ///< its state
  };
  /// Counts what it tries in `found`.
  using TryStep = void (ModelWalker::*)(const Step&, Findings& found);
  struct Trial {
    const char* name;
    const char* unit;
    const char* meaning;
    TryStep try_step;  ///< null: what is found elsewhere
    bool is_note = false;
  };
  static constexpr std::size_t kDefined = 0, kGradient = 6, kSane = 7, kTrials = 10;
  static const std::array<Trial, kTrials>& trials() {
    static constexpr std::array<Trial, kTrials> all{{
        {"defined", "conversions", "steps of the grid that C fails on", nullptr},
        {"deterministic", "conversions",
         "C, asked again, answers with other bits: no two runs will give the same grid",
         &ModelWalker::try_again},
        {"stays", "states",
         "C(s, x, 0) is another state than s: a state that was reached is not at rest",
         &ModelWalker::try_to_stay},
        {"reflexive", "states", "the tolerance function says that a state differs from itself",
         &ModelWalker::try_reflexive},
        {"symmetric", "pairs", "the tolerance function depends on the order of its arguments",
         &ModelWalker::try_symmetric},
        {"finite", "calls", "force or shape that is not finite", &ModelWalker::try_force},
        {"gradient", "forces",
         "the force is not the energy's negative gradient: a loop of the hand would gain or lose "
         "energy",
         nullptr},
        {"sane", "parameters", "what the model itself says against its parameters", nullptr},
        {"halves", "conversions",
         "a step in two halves ends in another state: that is right near a tear-off; elsewhere C "
         "walks too coarsely",
         &ModelWalker::try_halves, true},
        {"returns", "conversions",
         "a step there and back ends in another state: levels are there for such hysteresis; many "
         "of them mean that C is less exact than its tolerance",
         &ModelWalker::try_to_return, true},
    }};
    return all;
  }

  std::string text_of(const Step& step) const {
    return format("{} direction {} from state {}", describe(spec_.box, step.point), step.q,
                  state_text(step.from));
  }

  bool same(const State& a, const State& b) const { return model_->equal(a.data(), b.data()); }

  std::string state_of(const State& row) const {
    return state_text(std::span(row).first(spec_.state_size));
  }

  /// Makes one step of the walk and all trials there. Returns whether the walk can go on.
  bool step(int q) {
    const Vec3 x = spec_.box.position(point_);
    const Vec3& d = around_.shift(q);
    Step step{point_, q, x, d, x + d, state_, {}, {}};
    step.row.resize(spec_.row_size());
    Findings& defined = found_[kDefined];
    ++defined.counted;
    const double before = now();
    const bool converted = convert(step.from, x, d, step.row);
    convert_seconds_.push_back(now() - before);
    if (!converted) {
      defined.offend([&] { return text_of(step) + ": " + model_->error(); });
      return false;
    }
    step.arrived.assign(step.row.begin(), step.row.begin() + spec_.state_size);
    for (std::size_t i = 0; i < kTrials; ++i)
      if (trials()[i].try_step) (this->*trials()[i].try_step)(step, found_[i]);
    point_ = static_cast<PointIndex>(std::int64_t{point_} + around_.offset(q));
    state_ = step.arrived;
    return true;
  }

  bool convert(const State& s, const Vec3& x, const Vec3& d, State& row) {
    return model_->convert(s.data(), x, d, row.data());
  }

  /// The same bits from a second model, and from this one, whatever it did in between.
  void try_again(const Step& step, Findings& found) {
    for (Model* model : {second_.get(), model_.get()}) {
      ++found.counted;
      if (!model->convert(step.from.data(), step.x, step.d, other_.data()) ||
          std::memcmp(other_.data(), step.row.data(), step.row.size() * sizeof(double)) != 0)
        found.offend([&] {
          return format("{}: {}, then {}", text_of(step), state_text(step.arrived),
                        state_of(other_));
        });
    }
  }

  void try_to_stay(const Step& step, Findings& found) {
    ++found.counted;
    if (!convert(step.arrived, step.there, {0, 0, 0}, other_) || !same(other_, step.arrived))
      found.offend([&] {
        return format("{}: from {} to {}", describe(spec_.box, step.point),
                      state_text(step.arrived), state_of(other_));
      });
  }

  void try_to_return(const Step& step, Findings& found) {
    ++found.counted;
    const Vec3 back{-step.d[0], -step.d[1], -step.d[2]};
    if (!convert(step.arrived, step.there, back, other_) || !same(other_, step.from))
      found.offend([&] { return text_of(step) + ": back in " + state_of(other_); });
  }

  void try_halves(const Step& step, Findings& found) {
    ++found.counted;
    const Vec3 half = 0.5 * step.d;
    const Vec3 middle = step.x + half;
    State halfway(spec_.row_size());
    if (!convert(step.from, step.x, half, halfway) || !convert(halfway, middle, half, other_) ||
        !same(other_, step.arrived))
      found.offend([&] {
        return format("{}: at once {}, in two halves {}", text_of(step), state_text(step.arrived),
                      state_of(other_));
      });
  }

  void try_reflexive(const Step& step, Findings& found) {
    ++found.counted;
    if (!same(step.arrived, step.arrived)) found.offend([&] { return state_text(step.arrived); });
  }

  void try_symmetric(const Step& step, Findings& found) {
    ++found.counted;
    if (same(step.arrived, step.from) != same(step.from, step.arrived))
      found.offend([&] { return state_text(step.arrived) + " and " + state_text(step.from); });
  }

  /// Force and shape in the state reached are finite. Also notes the energy's gradient there.
  void try_force(const Step& step, Findings& finite) {
    const Vec3& x = step.there;
    State row = step.arrived;
    row.resize(spec_.row_size());
    if (fields_.asks_for_shape()) {
      std::vector<float> centres(std::size_t{3} * fields_.spheres().size());
      const double before = now();
      fields_.shape(row, centres);
      shape_seconds_.push_back(now() - before);
      ++finite.counted;
      if (!std::all_of(centres.begin(), centres.end(), [](float c) { return std::isfinite(c); }))
        finite.offend([&] { return "shape in state " + state_text(step.arrived); });
    }
    if (!fields_.has_force()) return;
    if (is_stored_ && !model_->complete(x, row.data())) return;  // convert() has reported that
    const double before = now();
    const Vec3 force = fields_.force(x, row);
    if (fields_.asks_for_force()) force_seconds_.push_back(now() - before);
    ++finite.counted;
    const double magnitude = std::hypot(force[0], force[1], force[2]);
    if (!std::isfinite(magnitude))
      return finite.offend([&] { return "force in state " + state_text(step.arrived); });
    largest_force_ = std::max(largest_force_, magnitude);
    if (fields_.has_energy()) add_gradient(x, row, force);
  }

  /// E of the state that the model takes on when the HIP moves a little: C of both sides, where
  /// both come back to s (no tear-off in between).
  void add_gradient(const Vec3& x, const State& row, const Vec3& force) {
    const double here = fields_.energy(x, row);
    const int axis = static_cast<int>(gradients_.size() % 3);
    const double e = kDifferenceStep * spec_.box.spacing;
    std::array<double, 2> slope{};  // before x and behind it
    for (int side = 0; side < 2; ++side) {
      Vec3 d{0, 0, 0};
      d[axis] = side ? e : -e;
      const Vec3 beside = x + d;
      State moved(spec_.row_size()), back(spec_.row_size());
      if (!convert(row, x, d, moved) || !convert(moved, beside, {-d[0], -d[1], -d[2]}, back) ||
          !same(back, row))
        return;
      slope[static_cast<std::size_t>(side)] = (fields_.energy(beside, moved) - here) / d[axis];
    }
    // Where the force changes much within the step, as before a tear-off, it is between the two.
    const double scale = -fields_.force_scale();
    const auto [low, high] = std::minmax({scale * slope[0], scale * slope[1]});
    gradients_.push_back({force[axis], std::clamp(force[axis], low, high), x, axis});
  }

  /// What the model itself says against its parameters.
  void ask_model() {
    if (!model_->has_check()) return;
    for (const std::string& problem : model_->check())
      found_[kSane].offend([&] { return problem; });
    found_[kSane].counted =
        std::max<std::uint64_t>(spec_.parameters.size(), found_[kSane].offenders);
  }

  /// Compares forces and gradients; also gives the median of the errors.
  Findings compare_gradients(double& median_error) {
    Findings gradient;
    std::vector<double> errors;
    for (const Gradient& g : gradients_) {
      ++gradient.counted;
      const double error = std::abs(g.force - g.difference) / std::max(largest_force_, 1e-300);
      if (g.force != 0) errors.push_back(error);  // where nothing is felt all is well, and common
      if (!(error <= kForceTolerance))
        gradient.offend([&] {
          return format("at ({}, {}, {}): force {} {} N, the energy's gradient gives {}",
                        to_text(g.x[0]), to_text(g.x[1]), to_text(g.x[2]), "xyz"[g.axis],
                        to_text(g.force), to_text(g.difference));
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
    ModelCheck out;
    found_[kGradient] = compare_gradients(out.median_force_error);
    out.convert = summary(convert_seconds_);
    out.force = summary(force_seconds_);
    out.shape = summary(shape_seconds_);
    out.largest_force = largest_force_;
    for (std::size_t i = 0; i < kTrials; ++i) {
      const Trial& trial = trials()[i];
      if (found_[i].counted > 0)
        out.checks.push_back(
            {trial.name, trial.unit, trial.meaning, std::move(found_[i]), trial.is_note});
    }
    return out;
  }

  struct Gradient {
    double force, difference;
    Vec3 x;
    int axis;
  };

  const GridSpec& spec_;
  const std::map<PointIndex, State>& seeds_;
  const std::uint64_t most_steps_;
  const double most_seconds_;
  std::unique_ptr<Model> model_;
  std::unique_ptr<Model> second_;
  const Fields fields_;
  const bool is_stored_;  // whether there is more in a row than the state
  Neighbourhood around_;
  SplitMix64 random_;
  PointIndex point_ = 0;
  State state_;
  State other_;  // a row
  std::array<Findings, kTrials> found_;
  std::vector<double> convert_seconds_, force_seconds_, shape_seconds_;
  std::vector<Gradient> gradients_;
  double largest_force_ = 0;
};

}  // namespace

ModelCheck check_model(const GridSpec& spec, const std::map<PointIndex, std::vector<double>>& seeds,
                       const MakeModel& make_model, std::uint64_t most_steps, double most_seconds) {
  return ModelWalker(spec, seeds, make_model, most_steps, most_seconds).run();
}

}  // namespace hapgrid
