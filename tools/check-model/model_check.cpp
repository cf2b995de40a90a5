#include "tools/check-model/model_check.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "libcore/base/format.hpp"
#include "libcore/base/random.hpp"
#include "libcore/base/text.hpp"
#include "libcore/check/fidelity.hpp"
#include "libcore/check/force_check.hpp"
#include "libcore/check/snaps.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/model/state_distance.hpp"
#include "libcore/search/converter.hpp"
#include "tools/check-model/remarks.hpp"
#include "tools/check-model/rows.hpp"
#include "tools/check-model/together.hpp"

namespace hapgrid {

namespace {

using State = std::vector<double>;

// Of the tolerance: bits that differ by no more than this are rounding, which no grid shows.
constexpr double kLastBits = 1e-3;
// Of what is stored with a state, where it is above 1 of that: as check_stored() has it.
constexpr double kStoredRounding = 1e-6;
// Steps that two models are asked again side by side, and their share of the time for the walks.
constexpr std::size_t kTogether = 256;
constexpr double kTogetherShare = 0.1;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The direction of the next step from one grid point straight to another; the points differ.
int direction_to(const Box& box, PointIndex from, PointIndex to) {
  const GridCoordinates a = box.coordinates(from), b = box.coordinates(to);
  const auto sign = [&](int i) { return (b[i] > a[i]) - (b[i] < a[i]); };
  return Direction::of(sign(0), sign(1), sign(2)).q();
}

class ModelWalker {
 public:
  ModelWalker(const GridSpec& spec, const std::map<PointIndex, State>& seeds,
              const MakeModel& make_model, std::uint64_t most_steps, double most_seconds)
      : spec_(spec),
        seeds_(seeds),
        most_steps_(most_steps),
        most_seconds_(most_seconds),
        model_(started(make_model)),
        second_(model_->info().processes == 1 && model_->is_process() ? nullptr
                                                                      : started(make_model)),
        forces_(spec, *model_),
        around_(spec.box),
        random_(1),
        other_(spec.row_size()) {}

  ModelCheck run() {
    walk();
    ask_among_others();
    ask_two_together();
    return result();
  }

 private:
  static constexpr int kLegs = 4;

  /// A model that has answered a question: a process loads its libraries meanwhile.
  std::unique_ptr<Model> started(const MakeModel& make_model) {
    const double before = now();
    std::unique_ptr<Model> model = make_model();
    static_cast<void>(model->known_states(spec_.box.position(seeds_.begin()->first)));
    start_seconds_ = std::max(start_seconds_, now() - before);
    start_ = now();
    return model;
  }

  void walk() {
    std::uint64_t steps = 0;
    while (steps < most_steps_) {
      auto seed = seeds_.begin();
      std::advance(seed, static_cast<std::ptrdiff_t>(random_.below(seeds_.size())));
      point_ = seed->first;
      const std::size_t n = spec_.state_size, level = random_.below(seed->second.size() / n);
      const double* const known = &seed->second[level * n];
      state_.assign(known, known + n);
      // A walk has several targets: the next leg starts where the last one ended.
      for (int leg = 0; leg < kLegs && steps < most_steps_; ++leg) {
        const auto target = static_cast<PointIndex>(random_.below(spec_.box.points()));
        for (; leg < kLegs && point_ != target && steps < most_steps_; ++steps) {
          if (steps > 0 && is_late()) return;
          memory_.look(steps, [&] { return model_->memory_bytes(); });
          if (!step(direction_to(spec_.box, point_, target))) leg = kLegs;
        }
      }
      if (spec_.box.points() == 1) break;
    }
  }

  /// A step of a walk: C has carried on `from` at x by d.
  struct Step : Made {
    Vec3 there;
    State arrived;  ///< the state of `row`
  };
  /// Counts what it tries in `found`.
  using TryStep = void (ModelWalker::*)(const Step&, Findings& found);
  static TryStep try_of(std::size_t row) {
    using W = ModelWalker;
    static constexpr std::array<TryStep, kRows.size()> kTries{
        nullptr,         &W::try_again,   nullptr,           nullptr,
        &W::try_to_stay, &W::try_to_push, &W::try_reflexive, &W::try_symmetric,
        &W::try_force,   nullptr,         &W::try_halves,    &W::try_to_return,
        nullptr};
    return kTries[row];
  }

  bool is_late() const { return now() - start_ > most_seconds_; }

  std::string text_of(const Made& step) const {
    return format("{} direction {} from state {}", describe(spec_.box, step.point), step.q,
                  state_text(step.from));
  }

  bool same(const State& a, const State& b) const { return model_->equal(a.data(), b.data()); }

  std::string state_of(const State& row) const {
    return state_text(std::span(row).first(spec_.state_size));
  }
  /// How two states differ, which the first four components need not show.
  std::string between(const State& a, const State& b) const {
    std::size_t most = 0;
    for (std::size_t i = 1; i < spec_.state_size; ++i)
      if (!(std::abs(a[i] - b[i]) <= std::abs(a[most] - b[most]))) most = i;
    const std::string by = format("by {}", rounded(std::abs(a[most] - b[most])));
    return spec_.state_size == 1 ? ", " + by : format(", component {} differs most, {}", most, by);
  }

  /// Makes one step of the walk and all trials there. Returns whether the walk can go on.
  bool step(int q) {
    const Vec3 x = spec_.box.position(point_);
    const Vec3& d = around_.shift(q);
    Step step{{point_, q, x, d, state_, {}}, x + d, {}};
    step.row.resize(spec_.row_size());
    current_conversion() = {step.point, 0, q};
    const double before = now();
    const bool converted = convert(step, "", step.from, x, d, step.row);
    convert_seconds_.push_back(now() - before);
    if (!converted) return false;
    step.arrived.assign(step.row.begin(), step.row.begin() + spec_.state_size);
    for (std::size_t i = 0; i < kRows.size(); ++i)
      if (try_of(i) && !is_late()) (this->*try_of(i))(step, found_[i]);
    point_ = static_cast<PointIndex>(std::int64_t{point_} + around_.offset(q));
    state_ = step.arrived;
    if (steps_.size() < kTogether) steps_.push_back(std::move(step));
    current_conversion().q = -1;
    return true;
  }

  /// C of the first model. A failure is an offender of `defined`, whatever is tried.
  /// @param what of the step, for its message
  bool convert(const Step& step, const char* what, const State& s, const Vec3& x, const Vec3& d,
               State& row) {
    ++found_[kDefined].counted;
    if (model_->convert(s.data(), x, d, row.data())) return true;
    found_[kDefined].offend([&] { return text_of(step) + what + ": " + model_->error(); });
    return false;
  }

  /// The largest distance of states that are the same but for their last bits; infinite where they
  /// are not. What is stored with them must be the same, too.
  double rounding(std::span<const double> a, std::span<const double> b) {
    for (std::size_t i = spec_.state_size; i < a.size(); ++i)
      if (!(std::abs(a[i] - b[i]) <= kStoredRounding * std::max(1.0, std::abs(a[i]))))
        return INFINITY;
    return std::equal(a.begin(), a.begin() + spec_.state_size, b.begin())
               ? 0
               : state_distance(*model_, a, b);
  }

  /// The same bits from a second model, and from this one, whatever it did in between.
  void try_again(const Step& step, Findings& found) {
    for (Model* model : {second_ ? second_.get() : model_.get(), model_.get()}) {
      ++found.counted;
      if (!model->convert(step.from.data(), step.x, step.d, other_.data())) {
        largest_rounding_ = INFINITY;
        found.offend([&] { return text_of(step) + ", asked again: " + model->error(); });
      } else if (std::memcmp(other_.data(), step.row.data(), step.row.size() * sizeof(double)) !=
                 0) {
        largest_rounding_ = std::max(largest_rounding_, rounding(step.row, other_));
        found.offend([&] {
          return format("{}: {}, then {}{}", text_of(step), state_text(step.arrived),
                        state_of(other_), between(step.arrived, other_));
        });
      }
    }
  }

  /// A process has several questions at a time, which it may answer as one batch. Alone it has
  /// answered them before.
  void ask_among_others() {
    if (!model_->is_process() || model_->info().in_flight == 1 || largest_rounding_ > 0) return;
    found_[kAmong] = ask_at_a_time(
        *model_, steps_, kTogetherShare * most_seconds_,
        [&](const Made& step, std::span<const double> row) {
          if (std::memcmp(row.data(), step.row.data(), row.size_bytes()) == 0) return std::string();
          among_rounding_ = std::max(among_rounding_, rounding(step.row, row));
          return between(step.row, State(row.begin(), row.end()));
        },
        [&](const Made& step) { return text_of(step); });
  }

  void ask_two_together() {
    // One that is not the same alone, or in one thread, has its own row.
    if (!second_ || model_->info().processes == 1 || found_[kAmong].offenders > 0 ||
        largest_rounding_ > kLastBits * spec_.tolerance)
      return;
    found_[kTogetherRow] = ask_together(
        *model_, *second_, steps_, kTogetherShare * most_seconds_,
        [&](const Made& step, std::span<const double> row) {
          return rounding(step.row, row) <= kLastBits * spec_.tolerance
                     ? std::string()
                     : between(step.row, State(row.begin(), row.end()));
        },
        [&](const Made& step) { return text_of(step); });
  }

  void try_to_stay(const Step& step, Findings& found) {
    if (!convert(step, ", asked to stay", step.arrived, step.there, {0, 0, 0}, other_)) return;
    ++found.counted;
    if (!same(other_, step.arrived))
      found.offend([&] {
        return format("{}: from {} to {}{}", describe(spec_.box, step.point),
                      state_text(step.arrived), state_of(other_), between(other_, step.arrived));
      });
  }

  void try_to_push(const Step& step, Findings& found) {
    ++found.counted;
    const std::string where = falls_away(*model_, spec_, step.arrived, step.there);
    if (!where.empty())
      found.offend([&] {
        return format("{}: {} {}", describe(spec_.box, step.point), state_text(step.arrived),
                      where);
      });
  }

  void try_to_return(const Step& step, Findings& found) {
    if (!convert(step, ", on the way back", step.arrived, step.there, -1 * step.d, other_)) return;
    ++found.counted;
    if (same(other_, step.from))
      return returned_.push_back(state_distance(*model_, other_, step.from));
    found.offend([&] {
      return text_of(step) + ": back in " + state_of(other_) + between(other_, step.from);
    });
    walk_in_pieces(step);
  }

  /// Where the model snaps, a C that leaps ends elsewhere when it makes shorter steps.
  void walk_in_pieces(const Step& step) {
    Findings& snaps = found_[kSnaps];
    std::string why;
    const auto converted =
        convert_in_pieces(*model_, step.from, step.x, step.d, other_, [this] { return is_late(); });
    if (!converted) return;
    if (!*converted)
      why = model_->error();
    else if (!same(other_, step.arrived))
      why = format("at once {}, in {} pieces {}{}", state_text(step.arrived), kPieces,
                   state_of(other_), between(other_, step.arrived));
    ++snaps.counted;
    if (!why.empty()) snaps.offend([&] { return text_of(step) + ": " + why; });
  }

  void try_halves(const Step& step, Findings& found) {
    const Vec3 half = 0.5 * step.d;
    const Vec3 middle = step.x + half;
    State halfway(spec_.row_size());
    if (!convert(step, ", in two halves", step.from, step.x, half, halfway) ||
        !convert(step, ", in two halves", halfway, middle, half, other_))
      return;
    ++found.counted;
    if (same(other_, step.arrived)) return;
    apart_.push_back(state_distance(*model_, other_, step.arrived));
    found.offend([&] {
      return format("{}: at once {}, in two halves {}{}", text_of(step), state_text(step.arrived),
                    state_of(other_), between(other_, step.arrived));
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

  void try_force(const Step& step, Findings& finite) {
    forces_.try_at(step.there, step.arrived, finite);
  }

  /// What the model itself says against its parameters.
  void ask_model() {
    if (!model_->has_check()) return;
    for (const std::string& problem : model_->check())
      found_[kSane].offend([&] { return problem; });
    found_[kSane].counted =
        std::max<std::uint64_t>(spec_.parameters.size(), found_[kSane].offenders);
  }

  /// What is to be said of a trial's row beside its offenders.
  void complete_row(std::size_t trial, Check& check) {
    if (trial == kDeterministic && largest_rounding_ <= kLastBits * spec_.tolerance) {
      check.is_note = check.found.offenders > 0;
      check.meaning = format(
          "C, asked again, answers with other last bits, which differ by up to {}. That is far "
          "below the tolerance, {}; but no two runs will give the same bytes",
          rounded(largest_rounding_), rounded(spec_.tolerance));
    }
    if (trial == kAmong && check.found.offenders > 0 &&
        among_rounding_ <= kLastBits * spec_.tolerance) {
      check.is_note = true;
      check.remark = "C's last bits depend on what is asked beside it";
      check.meaning += format(
          ". The answers differ by up to {}, far below the tolerance, {}; but other numbers of "
          "parts "
          "and threads give other bytes",
          rounded(among_rounding_), rounded(spec_.tolerance));
    }
    if (trial == kHalves) judge_halves(check, apart_, spec_);
    if (trial == kReturns) check.figures = {exactness(returned_, spec_)};
    if (trial != kSnaps) return;
    check.remark = remark_on_snaps(check.found);
    judge_snaps(check);
  }

  ModelCheck result() {
    ask_model();
    ModelCheck out;
    for (std::optional<Check> check :
         {note_felt(forces_.has_force(), forces_.largest_force, found_[kFinite].counted),
          note_spread(returned_, spec_), memory_.note()})
      if (check) out.checks.push_back(std::move(*check));
    out.start_seconds = start_seconds_ + take_first_ones(convert_seconds_);
    out.convert = summary(convert_seconds_);
    out.force = summary(forces_.force_seconds);
    out.shape = summary(forces_.shape_seconds);
    out.largest_force = forces_.largest_force;
    out.median_force_error = forces_.median_error();
    for (std::size_t i = 0; i < kRows.size(); ++i) {
      const Row& trial = kRows[i];
      if (i == kSane)  // behind `finite`
        for (Check& check : forces_.checks()) out.checks.push_back(std::move(check));
      if (found_[i].counted == 0) continue;
      Check check{trial.name, trial.unit, trial.meaning, std::move(found_[i]), trial.is_note};
      complete_row(i, check);
      out.checks.push_back(std::move(check));
    }
    return out;
  }

  const GridSpec& spec_;
  const std::map<PointIndex, State>& seeds_;
  const std::uint64_t most_steps_;
  const double most_seconds_;
  double start_ = 0, start_seconds_ = 0;  // of the walks; of a model
  std::unique_ptr<Model> model_, second_;
  ForceCheck forces_;
  Neighbourhood around_;
  SplitMix64 random_;
  PointIndex point_ = 0;
  State state_, other_;  // the second one is a row
  std::array<Findings, kRows.size()> found_;
  std::vector<double> convert_seconds_;
  std::vector<double> apart_;                         // by how much halves differ, where they do
  std::vector<double> returned_;                      // how far from where they began
  std::vector<Made> steps_;                           // the first ones, to be asked again
  double largest_rounding_ = 0, among_rounding_ = 0;  // of C, asked again; asked among others
  MemoryLog memory_;
};

}  // namespace

ModelCheck check_model(const GridSpec& spec, const std::map<PointIndex, std::vector<double>>& seeds,
                       const MakeModel& make_model, std::uint64_t most_steps, double most_seconds) {
  return ModelWalker(spec, seeds, make_model, most_steps, most_seconds).run();
}

}  // namespace hapgrid
