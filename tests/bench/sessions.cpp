#include "tests/bench/sessions.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kMilli = 1e3;
constexpr double kNano = 1e9;
constexpr double kContact = 0.01;  // newtons, of the model's force or the one that is played

/// A figure over all sessions that have it.
struct Overall {
  double mean = 0;
  double worst = 0;
  std::size_t session = 0;  ///< the first one that is the worst
  std::uint64_t count = 0;
};

template <class Has>
Overall overall(const std::vector<SessionFigures>& sessions, double SessionFigures::*figure,
                Has&& has) {
  Overall all;
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    if (!has(sessions[i])) continue;
    const double value = sessions[i].*figure;
    if (all.count == 0 || value > all.worst) {
      all.worst = value;
      all.session = i;
    }
    ++all.count;
    all.mean += value;
  }
  if (all.count > 0) all.mean /= static_cast<double>(all.count);
  return all;
}

struct Summary {
  Overall returned, oscillation, step;
  std::uint64_t holds = 0;
};

Summary summarize(const std::vector<SessionFigures>& sessions) {
  const auto any = [](const SessionFigures&) { return true; };
  Summary s{overall(sessions, &SessionFigures::returned_mj, any),
            overall(sessions, &SessionFigures::oscillation_mm,
                    [](const SessionFigures& f) { return f.holds > 0; }),
            overall(sessions, &SessionFigures::largest_step_n, any), 0};
  for (const SessionFigures& f : sessions) s.holds += f.holds;
  return s;
}

}  // namespace

void ForceError::add(double newtons) noexcept {
  sum_ += newtons;
  constexpr double kMost = 1e9;  // newtons, far below the largest whole number of nanonewtons
  nanonewtons_.add(static_cast<std::int64_t>(std::min(newtons, kMost) * kNano));
}

void ForceError::add(const ForceError& other) noexcept {
  sum_ += other.sum_;
  nanonewtons_.add(other.nanonewtons_);
}

double ForceError::mean() const { return ticks() > 0 ? sum_ / static_cast<double>(ticks()) : 0; }

double ForceError::p99() const { return static_cast<double>(nanonewtons_.quantile(0.99)) / kNano; }

Sessions::Sessions(const SimulatedDevice& device, const SafetyCore& safety, const Fields& fields,
                   const Setup& setup, Traversal* truth)
    : device_(device),
      safety_(safety),
      fields_(fields),
      setup_(setup),
      truth_(truth),
      positions_(static_cast<std::size_t>(std::max(std::round(setup.rate_hz), 1.0))) {}

void Sessions::add(const Tick& tick) {
  if (tick.input.begins) begin();
  SessionFigures& now = sessions_.back();
  now.stored_mj = safety_.granted() * kMilli;
  now.given_mj = device_.work() * kMilli;
  now.returned_mj = std::max(now.returned_mj, now.given_mj - now.stored_mj);
  now.largest_step_n = std::max(now.largest_step_n, length_of(tick.force.force - last_sent_));
  last_sent_ = tick.force.force;
  note_position();
  if (truth_) compare(tick);
}

void Sessions::finish() {
  if (!sessions_.empty()) end();
}

void Sessions::begin() {
  if (!sessions_.empty()) end();
  sessions_.emplace_back();
  last_sent_ = {0, 0, 0};
  last_target_ = device_.target();
  rest_ = 0;
}

/// Closes the session.
void Sessions::end() {
  judge_rest();
  SessionFigures& s = sessions_.back();
  s.contact = session_sent_.ticks();
  s.sent_mean_n = session_sent_.mean();
  s.sent_p99_n = session_sent_.p99();
  s.raw_mean_n = session_raw_.mean();
  s.raw_p99_n = session_raw_.p99();
  if (s.contact == 0) return;
  sent_.add(session_sent_);
  raw_.add(session_raw_);
  session_sent_ = session_raw_ = {};
}

void Sessions::note_position() {
  if (device_.target() != last_target_) judge_rest();
  last_target_ = device_.target();
  ++rest_;
  positions_[next_] = device_.position();
  next_ = (next_ + 1) % positions_.size();
}

/// The hand's point moves on, or the session is over: the last second of a rest that was as long
/// counts.
void Sessions::judge_rest() {
  const bool counts = rest_ >= positions_.size();
  rest_ = 0;
  if (!counts) return;
  SessionFigures& now = sessions_.back();
  ++now.holds;
  for (int a = 0; a < 3; ++a) {
    const auto [low, high] =
        std::minmax_element(positions_.begin(), positions_.end(),
                            [a](const Vec3& x, const Vec3& y) { return x[a] < y[a]; });
    now.oscillation_mm = std::max(now.oscillation_mm, ((*high)[a] - (*low)[a]) * kMilli);
  }
}

void Sessions::compare(const Tick& tick) {
  const Level chosen = tick.step.chosen;
  const StepResult step = tick.input.begins    ? truth_->start(tick.hip)
                          : chosen != kNoLevel ? truth_->start(tick.hip, chosen)
                                               : truth_->step(tick.hip);
  if (!step.usable() || !finite(tick.raw_force)) return;
  const Vec3 model = fields_.force(truth_->position(), truth_->row());
  if (std::max(length_of(model), length_of(tick.raw_force)) < kContact) return;
  const Vec3 felt = setup_.gain * model;
  session_sent_.add(length_of(tick.force.force - felt));
  session_raw_.add(length_of(tick.raw_force - model));
}

std::string sessions_text(const Sessions& sessions) {
  const auto line = [](const std::string& what, const Overall& o, const char* unit) {
    return format("hands: {}: mean {:.3g} {}, worst {:.3g} {} in session {}\n", what, o.mean, unit,
                  o.worst, unit, o.session);
  };
  const Summary s = summarize(sessions.sessions());
  std::string text = line(
      format("energy returned beyond what was stored, of {} sessions", sessions.sessions().size()),
      s.returned, "mJ");
  if (s.holds > 0)
    text += line(format("oscillation in {} rests of the hand", s.holds), s.oscillation, "mm");
  text += line("largest step of the force in a tick", s.step, "N");
  if (!sessions.has_truth()) return text;
  const auto error = [](const ForceError& e) {
    return format("mean {:.3g} N, 99 % {:.3g} N", e.mean(), e.p99());
  };
  return text + format(
                    "hands: error of the force in {} ticks in contact: {} as sent; {} before the "
                    "safety core\n",
                    sessions.sent_error().ticks(), error(sessions.sent_error()),
                    error(sessions.raw_error()));
}

Json sessions_json(const Sessions& sessions) {
  const auto overall_json = [](const Overall& o) {
    return Json{{"mean", o.mean}, {"worst", o.worst}, {"session", o.session}};
  };
  const Summary s = summarize(sessions.sessions());
  Json json{{"sessions", sessions.sessions().size()},
            {"returned_mJ", overall_json(s.returned)},
            {"holds", s.holds},
            {"oscillation_mm", s.holds > 0 ? overall_json(s.oscillation) : Json()},
            {"largest_step_N", overall_json(s.step)}};
  if (!sessions.has_truth()) return json;
  const auto error = [](const ForceError& e) { return Json{{"mean", e.mean()}, {"p99", e.p99()}}; };
  json["ticks_in_contact"] = sessions.sent_error().ticks();
  json["error_sent_N"] = error(sessions.sent_error());
  json["error_before_safety_N"] = error(sessions.raw_error());
  return json;
}

std::string sessions_table(const Sessions& sessions) {
  std::string text =
      "# session\tstored_mJ\tgiven_mJ\treturned_mJ\tholds\toscillation_mm\tlargest_step_N";
  if (sessions.has_truth())
    text += "\tcontact_ticks\tsent_mean_N\tsent_p99_N\traw_mean_N\traw_p99_N";
  text += '\n';
  for (std::size_t i = 0; i < sessions.sessions().size(); ++i) {
    const SessionFigures& s = sessions.sessions()[i];
    text += format("{}\t{}\t{}\t{}\t{}\t{}\t{}", i, to_text(s.stored_mj), to_text(s.given_mj),
                   to_text(s.returned_mj), s.holds, to_text(s.oscillation_mm),
                   to_text(s.largest_step_n));
    if (sessions.has_truth())
      text += format("\t{}\t{}\t{}\t{}\t{}", s.contact, to_text(s.sent_mean_n),
                     to_text(s.sent_p99_n), to_text(s.raw_mean_n), to_text(s.raw_p99_n));
    text += '\n';
  }
  return text;
}

}  // namespace hapgrid
