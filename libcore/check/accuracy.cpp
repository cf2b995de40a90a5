#include "libcore/check/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

constexpr double kMostPlaces = 0.99;       // that must be below the wanted error
constexpr std::size_t kLeastPlaces = 100;  // in which an order is told: of fewer, 99 % are all
constexpr double kLeastOrder = 0.75;  // kinks have 1; below, the spacing does not resolve the state
constexpr double kHighestOrder = 2;   // of multilinear interpolation

/// The least of the values that `share` of them do not exceed; 0 when there are none.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// One of the errors of each place that has it.
std::vector<double> column(const std::vector<PlayError>& errors, double PlayError::*error,
                           bool with_coarse_only = false) {
  std::vector<double> values;
  for (const PlayError& e : errors)
    if (!with_coarse_only || !std::isnan(e.coarse_state)) values.push_back(e.*error);
  return values;
}

std::string points_text(const Box& box, double spacing) {
  std::string text;
  for (int a = 0; a < 3; ++a) {
    const double cells = std::ceil((box.counts[a] - 1) * box.spacing / spacing);
    text += (a == 0 ? "" : " x ") + fixed(box.counts[a] == 1 ? 1 : std::max(cells, 1.0) + 1, 0);
  }
  return text + " points";
}

void add(Check& check, const std::string& name, double value, const std::string& unit,
         const std::string& where = "") {
  check.figures.push_back({name, value, unit, where});
}

void add_shares(Check& check, const GridSpec& spec, const Walked& walked) {
  const auto share = [&](std::uint64_t count) {
    return walked.places == 0 ? 0 : static_cast<double>(count) / static_cast<double>(walked.places);
  };
  add(check, "one branch", share(walked.one_branch.size()), "",
      "of the places, and something changes there; the errors below are theirs");
  add(check, "empty", share(walked.empty), "", "where all corners and the model are in one state");
  add(check, "mixed", share(walked.mixed), "",
      walked.mixed_state.value > 0
          ? format("where a branch ends in the cell; the state is off by {} {} {}",
                   rounded(walked.mixed_state.value), printable_line(spec.tolerance_unit),
                   walked.mixed_state.where)
          : "where a branch ends in the cell");
  add(check, "parted", share(walked.parted), "",
      "where play and the model are in different branches");
}

void add_errors(Check& check, const Walked& walked, const std::string& of, const std::string& unit,
                double PlayError::*error, const Figure& worst) {
  const std::vector<double> values = column(walked.one_branch, error);
  add(check, of + " median", quantile(values, 0.5), unit);
  add(check, of + " 99 %", quantile(values, kMostPlaces), unit);
  add(check, of + " worst", worst.value, unit, worst.where);
}

/// How the errors fall with the spacing, and the spacing that suffices for the wanted one.
void add_estimate(Check& check, const GridSpec& spec, const Walked& walked,
                  std::optional<double> wanted) {
  const auto coarse = column(walked.one_branch, &PlayError::coarse_state, true);
  const double e = quantile(column(walked.one_branch, &PlayError::state, true), kMostPlaces);
  const double twice = quantile(coarse, kMostPlaces);
  if (coarse.size() < kLeastPlaces || !(e > 0)) return;
  const double order = std::log2(twice / e);
  const double median = quantile(column(walked.one_branch, &PlayError::state, true), 0.5);
  if (median > 0)
    add(check, "median order", std::log2(quantile(coarse, 0.5) / median), "",
        "how the median falls, as the next line says of the 99 %");
  add(check, "order", order, "",
      format("of the 99 %, which is {} with every other point, and here {} in the same places",
             rounded(twice), rounded(e)));
  if (!wanted || !(order > kLeastOrder)) {
    if (wanted) check.figures.back().where += "; too low to tell a sufficient spacing";
    return;
  }
  const double now = quantile(column(walked.one_branch, &PlayError::state), kMostPlaces);
  const double spacing =
      spec.box.spacing * std::pow(*wanted / now, 1 / std::min(order, kHighestOrder));
  add(check, "sufficient spacing", spacing, spec.length_unit,
      format("{}, for {} in 99 of 100 places", points_text(spec.box, spacing), rounded(*wanted)));
}

void judge(Check& check, const Walked& walked, std::optional<double> wanted) {
  check.found.offenders = walked.failed.offenders;
  check.found.first = walked.failed.first;
  if (!wanted) {
    check.meaning = "conversions that failed on the way";
    return;
  }
  const std::vector<double> errors = column(walked.one_branch, &PlayError::state);
  check.meaning = "places with an error above " + rounded(*wanted) +
                  ", where these are more than 1 in 100; and conversions that failed";
  if (quantile(errors, kMostPlaces) <= *wanted) return;
  check.found.offenders += static_cast<std::uint64_t>(
      std::count_if(errors.begin(), errors.end(), [&](double e) { return e > *wanted; }));
  auto& first = check.found.first;
  first.insert(first.begin(),
               {format("off by {} {}", rounded(walked.state.value), walked.state.where)});
  first.resize(std::min(first.size(), Findings::kShown));
}

}  // namespace

Check check_accurate(const GridSpec& spec, const Walked& walked, bool has_force,
                     std::optional<double> wanted) {
  Check check{"accurate", "places", "", {}};
  check.found.counted = walked.places;
  check.is_note = !wanted;
  add_shares(check, spec, walked);
  add_errors(check, walked, "state", spec.tolerance_unit, &PlayError::state, walked.state);
  if (has_force) add_errors(check, walked, "force", "N", &PlayError::force, walked.force);
  add_estimate(check, spec, walked, wanted);
  judge(check, walked, wanted);
  return check;
}

}  // namespace hapgrid
