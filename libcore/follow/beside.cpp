#include "libcore/follow/beside.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libcore/base/signals.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/model/state_distance.hpp"

namespace hapgrid {

namespace {

// Places that wait for a thread whose model is busy. Where there are more, the way between is
// straight.
constexpr std::size_t kPlaces = 4096;
// The thread looks for a new place so often in a tick, but not more often than this.
constexpr double kLooksATick = 4;
constexpr double kShortestPauseSeconds = 5e-5;
// Of the way ahead, in spacings: a hand that moves so far until an answer comes is too fast for it.
constexpr double kFarthest = 0.5;
// Step of the numerical derivative of the distance, in the component's unit.
constexpr double kChange = 1e-3;

BesideAnswer empty_answer(const Grid& grid) {
  BesideAnswer answer;
  answer.row.resize(grid.spec().row_size());
  return answer;
}

std::vector<double> weights_of(const Grid& grid, const Model& model) {
  constexpr RecordIndex kSamples = 16;
  std::vector<double> weights(grid.state_size());
  for (RecordIndex i = 0; i < kSamples; ++i) {
    const auto record = static_cast<RecordIndex>(std::uint64_t{i} * grid.records() / kSamples);
    const std::vector<double> state(grid.row(record).begin(),
                                    grid.row(record).begin() + grid.state_size());
    for (std::size_t c = 0; c < weights.size(); ++c) {
      std::vector<double> other = state;
      other[c] += kChange;
      weights[c] += state_distance(model, state, other) / (kChange * kSamples);
    }
  }
  return weights;
}

}  // namespace

Beside::Beside(const Grid& grid, std::unique_ptr<Model> model,
               std::optional<std::uint32_t> delay_ticks,
               std::function<void(const std::string&)> tell_failure)
    : weights_(weights_of(grid, *model)),
      is_process_(model->is_process()),
      fields_(grid.spec(), *model),
      model_(grid, std::move(model), kStepsACell),
      delay_(delay_ticks),
      box_(grid.box()),
      near_(grid.box().spacing / kStepsACell),
      tell_failure_(std::move(tell_failure)),
      held_back_(delay_ ? std::size_t{*delay_} + 1 : 0, empty_answer(grid)),
      places_(delay_ ? 1 : kPlaces),
      answers_(empty_answer(grid)) {}

Beside::~Beside() { end_within({}); }

bool Beside::end_within(std::chrono::milliseconds patience) noexcept {
  ends_ = true;
  thread_.request_stop();
  model_.abandon();
  const auto until = std::chrono::steady_clock::now() + patience;
  while (is_working_ && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return !is_working_;
}

void Beside::begin(double rate_hz) {
  pause_s_ = std::max(1 / (kLooksATick * rate_hz), kShortestPauseSeconds);
  if (delay_) return;
  const BlockedSignals blocked;
  is_working_ = true;
  thread_ = std::jthread([this](const std::stop_token& token) { work(token); });
}

void Beside::receive() noexcept {
  const std::uint64_t tick = tick_ + 1;
  const BesideAnswer* answer = nullptr;
  if (!delay_) {
    answers_.update();
    answer = &answers_.front();
  } else if (tick > *delay_) {
    answer = &held_back_[(tick - *delay_) % held_back_.size()];
  }
  newest_ = answer && answer->usable && answer->tick >= first_tick_ ? answer : nullptr;
  if (!newest_) return;
  lateness_.add(static_cast<std::int64_t>(tick - newest_->tick));
  ++ticks_kept_up_;
}

void Beside::tell(const Vec3& x, std::optional<Level> begins) noexcept {
  ++tick_;
  if (begins) {
    first_tick_ = tick_;
    newest_ = nullptr;
  }
  const Place place{tick_, x, look_ahead(x), begins ? begins : must_begin_};
  if (delay_)
    ask(place, held_back_[tick_ % held_back_.size()]);
  else
    must_begin_ = places_.push(place) ? std::nullopt : place.begins;
}

/// Where the hand will be when the answer comes, if it is as late as the last one. It is not asked
/// for more than kFarthest, and not outside the box.
Vec3 Beside::look_ahead(const Vec3& x) noexcept {
  last_places_[tick_ % kFarthestAhead] = x;
  const std::uint64_t late = delay_ ? *delay_ : newest_ ? tick_ - newest_->tick : 0;
  if (late >= kFarthestAhead || tick_ - first_tick_ < late) return x;
  Vec3 way = x - last_places_[(tick_ - late) % kFarthestAhead];
  const double length = length_of(way), most = kFarthest * box_.spacing;
  if (length > most) way = most / length * way;
  Vec3 ahead = x + way;
  for (int a = 0; a < 3; ++a)
    ahead[a] =
        std::clamp(ahead[a], box_.origin[a], box_.origin[a] + box_.spacing * (box_.counts[a] - 1));
  return ahead;
}

void Beside::ask(const Place& place, BesideAnswer& answer) noexcept {
  answer.tick = place.tick;
  answer.usable = false;
  if (has_given_up_) return;
  const StepResult& step =
      place.begins ? model_.start(place.x, *place.begins) : model_.step(place.x);
  answer.at = place.ahead == place.x ? model_.position() : place.ahead;
  answer.usable = step.usable() && model_.look_ahead(answer.at, answer.row);
  answer.force.reset();
  if (answer.usable && fields_.has_force()) {
    const Vec3 force = fields_.force(answer.at, answer.row);
    if (std::isfinite(length_of(force))) answer.force = force;
  }
  has_given_up_ = is_process_ && step.blocked;
  if (has_given_up_ && tell_failure_ && !ends_) tell_failure_(model_.model_error());
}

void Beside::work(const std::stop_token& token) noexcept {
  while (!token.stop_requested()) {
    const std::span<const Place> places = places_.peek();
    ask_all(places, token);
    places_.pop(places.size());
    if (places.empty()) std::this_thread::sleep_for(std::chrono::duration<double>(pause_s_));
  }
  is_working_ = false;
}

/// All places along which the hand has come since the thread looked last; the answer is that of the
/// newest.
void Beside::ask_all(std::span<const Place> places, const std::stop_token& token) noexcept {
  for (std::size_t i = 0; i < places.size() && !token.stop_requested(); ++i) {
    const Place& place = places[i];
    const bool is_last = i + 1 == places.size();
    if (!is_last && !place.begins && length_of(place.x - model_.position()) < near_) continue;
    ask(place, answers_.back());
    if (is_last) answers_.publish();
  }
}

}  // namespace hapgrid
