#include "libcore/check/force_check.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <string>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

// Of the spacing: small against what bends forces, large against rounding in energies.
constexpr double kDifferenceStep = 1e-3;
// Of the largest force: what a force may be off from the energy's gradient. A hand tells forces
// apart that differ by 5 to 10 % (Pang, Tan and Durlach 1991), so it does not notice this. A
// central difference over 2e-3 of the spacing is exact to some 1e-6; iterative models leave a
// residue.
constexpr double kForceTolerance = 0.02;
// Of the force along one axis: how far a factor between it and the slopes may be from 1. It is
// known far better than a single force, and a loop gains this part of the work along its axis.
constexpr double kFactorTolerance = 0.01;
constexpr double kSure = 4;  // standard errors
constexpr double kFelt =
    1e-4;                      // of the largest force: along an axis with less, slopes are rounding
constexpr int kAllAxes = 100;  // places where all axes are tried; behind them one of the three
// A factor explains the forces when less than this share of them, root mean square, is left: the
// least that a hand notices.
constexpr double kUnexplained = 0.05;
// Newtons. The strongest haptic devices send some 40.
constexpr double kStrong = 100;

template <class Call>
double seconds_of(Call&& call) {
  const auto before = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
}

/// "1,000 times", with three digits.
std::string times_text(double factor) {
  std::string text = format("{:.3g}", factor);
  if (factor >= 1000 && factor < 1e15) {
    const double unit = std::pow(10.0, std::floor(std::log10(factor)) - 2);
    text = format("{:.0f}", std::round(factor / unit) * unit);
    for (int at = static_cast<int>(text.size()) - 3; at > 0; at -= 3)
      text.insert(static_cast<std::size_t>(at), ",");
  }
  return text + " times";
}

}  // namespace

ForceCheck::ForceCheck(const GridSpec& spec, Model& model)
    : spec_(spec),
      model_(model),
      fields_(spec, model),
      is_stored_(spec.row_size() > spec.state_size) {}

void ForceCheck::try_at(const Vec3& x, std::span<const double> state, Findings& finite) {
  std::vector<double> row(state.begin(), state.end());
  row.resize(spec_.row_size());
  if (fields_.asks_for_shape()) {
    std::vector<float> centres(std::size_t{3} * fields_.spheres().size());
    shape_seconds.push_back(seconds_of([&] { fields_.shape(x, row, centres); }));
    ++finite.counted;
    if (!std::all_of(centres.begin(), centres.end(), [](float c) { return std::isfinite(c); }))
      finite.offend([&] { return "shape in state " + state_text(state); });
  }
  if (!fields_.has_force()) return;
  if (is_stored_ && !model_.complete(x, row.data())) return;  // convert() has reported that
  Vec3 force{};
  const double seconds = seconds_of([&] { force = fields_.force(x, row); });
  if (fields_.asks_for_force()) force_seconds.push_back(seconds);
  ++finite.counted;
  const double magnitude = length_of(force);
  if (!std::isfinite(magnitude))
    return finite.offend([&] { return "force in state " + state_text(state); });
  largest_force = std::max(largest_force, magnitude);
  ++strong_.counted;
  if (magnitude > kStrong)
    strong_.offend([&] {
      return format("{} N at ({}, {}, {}) in state {}", rounded(magnitude), rounded(x[0]),
                    rounded(x[1]), rounded(x[2]), state_text(state));
    });
  if (!fields_.has_energy()) return;
  const int place = places_++;
  for (int axis = 0; axis < 3; ++axis)
    if (place < kAllAxes || place % 3 == axis) add_gradient(x, row, force, axis);
}

void ForceCheck::add_gradient(const Vec3& x, const std::vector<double>& row, const Vec3& force,
                              int axis) {
  const double here = fields_.energy(x, row);
  const double e = kDifferenceStep * spec_.box.spacing;
  std::array<double, 2> slope{};  // before x and behind it
  for (int side = 0; side < 2; ++side) {
    Vec3 d{0, 0, 0};
    d[axis] = side ? e : -e;
    const Vec3 beside = x + d;
    std::vector<double> moved(spec_.row_size()), back(spec_.row_size());
    if (!model_.convert(row.data(), x, d, moved.data()) ||
        !model_.convert(moved.data(), beside, {-d[0], -d[1], -d[2]}, back.data()) ||
        !model_.equal(back.data(), row.data()))
      return;
    slope[static_cast<std::size_t>(side)] = (fields_.energy(beside, moved) - here) / d[axis];
  }
  // Where the force changes much within the step, as before a tear-off, it is between the two.
  const double scale = -fields_.force_scale();
  const auto [low, high] = std::minmax({scale * slope[0], scale * slope[1]});
  gradients_.push_back(
      {force[axis], (slope[0] + slope[1]) / 2, std::clamp(force[axis], low, high), x, axis});
}

/// What the forces have in common that are no gradients; empty when it is nothing.
std::string ForceCheck::diagnosis() const {
  double ff = 0, fg = 0, gg = 0;
  for (const Gradient& g : gradients_) {
    ff += g.force * g.force;
    fg += g.force * -g.slope;
    gg += g.slope * g.slope;
  }
  const double scale = fields_.force_scale();
  if (!(gg > 0) || !(ff > 0))
    return scale > 0 ? "" : "force_scale is 0, though the model has an energy";
  const double factor = fg / gg;  // the newtons that one unit of the gradient seems to be
  const bool explains = 1 - fg * factor / ff < kUnexplained * kUnexplained;
  if (!(scale > 0))
    return "force_scale is 0: it says how many newtons one unit of energy per unit of length is" +
           (explains && factor > 0 ? ", here " + rounded(factor) : "");
  if (!explains) return "";
  const double ratio = factor / scale;
  if (std::abs(ratio - 1) < kForceTolerance) return "";
  if (std::abs(ratio + 1) < kForceTolerance)
    return "the sign of the force is wrong: it points up the energy";
  std::string text = std::abs(ratio) >= 1 ? format("the force is {} the energy's negative gradient",
                                                   times_text(std::abs(ratio)))
                                          : format("the energy's negative gradient is {} the force",
                                                   times_text(1 / std::abs(ratio)));
  text += format(": is its unit right, or should force_scale be {}", rounded(std::abs(factor)));
  return text + (ratio < 0 ? "? Its sign is wrong, too" : "?");
}

/// Along one axis: what the forces are of the energy's slopes, when that is a factor beyond doubt
/// which is not 1; else empty. A small one is not seen in any single force.
std::string ForceCheck::axis_diagnosis(int axis) const {
  const double scale = fields_.force_scale();
  double n = 0, ff = 0, fg = 0, gg = 0;
  for (const Gradient& g : gradients_) {
    // The nearer slope, where it is between the two: a bend in between is no factor.
    const double slope = g.force == g.nearest ? g.force : -scale * g.slope;
    if (g.axis != axis) continue;
    ++n;
    ff += g.force * g.force;
    fg += g.force * slope;
    gg += slope * slope;
  }
  if (n < 3 || !(std::sqrt(gg / n) > kFelt * largest_force)) return "";
  const double factor = fg / gg;
  const double error = std::sqrt(std::max(0.0, ff - factor * fg) / (n - 1) / gg);
  if (std::abs(factor - 1) <= kFactorTolerance + kSure * error) return "";
  return format("along {} the force is {} times the energy's negative gradient", "xyz"[axis],
                rounded(factor));
}

double ForceCheck::median_error() const {
  std::vector<double> errors;
  for (const Gradient& g : gradients_)  // where nothing is felt all is well, and common
    if (g.force != 0)
      errors.push_back(std::abs(g.force - g.nearest) / std::max(largest_force, 1e-300));
  if (errors.empty()) return 0;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

Check ForceCheck::gradient() const {
  Check gradient{
      "gradient",
      "forces",
      "the force is not the energy's negative gradient: a loop of the hand would gain or "
      "lose energy",
      {}};
  for (const Gradient& g : gradients_) {
    ++gradient.found.counted;
    const double error = std::abs(g.force - g.nearest) / std::max(largest_force, 1e-300);
    if (!(error <= kForceTolerance))
      gradient.found.offend([&] {
        return format("at ({}, {}, {}): force {} {} N, the energy's gradient gives {}",
                      to_text(g.x[0]), to_text(g.x[1]), to_text(g.x[2]), "xyz"[g.axis],
                      to_text(g.force), to_text(g.nearest));
      });
  }
  std::string axes;
  const bool is_seen = gradient.found.offenders > 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::string why = axis_diagnosis(axis);
    if (why.empty()) continue;
    axes += (axes.empty() ? "" : "; ") + why;
    if (!is_seen) gradient.found.offend([&] { return why; });
  }
  if (is_seen)
    for (const std::string& why : {axes, diagnosis()})
      if (!why.empty()) gradient.meaning = why;
  return gradient;
}

std::vector<Check> ForceCheck::checks() const {
  std::vector<Check> checks;
  if (!gradients_.empty()) checks.push_back(gradient());
  if (strong_.offenders > 0)
    checks.push_back({"strong", "forces",
                      format("forces beyond {} N, which no device sends: is force_scale right, and "
                             "the force in newtons?",
                             kStrong),
                      strong_,
                      /*is_note=*/true});
  return checks;
}

}  // namespace hapgrid
