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
constexpr std::size_t kLeastPlaces = 100;  // in which an order is told
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

class Row {
 public:
  Row(const GridSpec& spec, const Walked& walked, bool has_force, std::optional<double> wanted)
      : spec_(spec), walked_(walked), has_force_(has_force), wanted_(wanted) {}

  Check check() {
    check_.found.counted = walked_.places;
    check_.is_note = !wanted_;
    add_shares();
    add_errors("state", spec_.tolerance_unit, &PlayError::state, walked_.state);
    if (has_force_) add_errors("force", "N", &PlayError::force, walked_.force);
    add_estimate();
    judge();
    return std::move(check_);
  }

 private:
  void add(const std::string& name, double value, const std::string& unit,
           const std::string& where = "") {
    check_.figures.push_back({name, value, unit, where});
  }

  void add_shares() {
    const auto share = [&](std::uint64_t count) {
      return walked_.places == 0 ? 0
                                 : static_cast<double>(count) / static_cast<double>(walked_.places);
    };
    add("one branch", share(walked_.one_branch.size()), "",
        "of the places, and something changes there; the errors below are theirs");
    add("empty", share(walked_.empty), "", "where all corners and the model are in one state");
    add("mixed", share(walked_.mixed), "",
        walked_.mixed_state.value > 0
            ? format("where a branch ends in the cell; the state is off by {} {} {}",
                     rounded(walked_.mixed_state.value), printable_line(spec_.tolerance_unit),
                     walked_.mixed_state.where)
            : "where a branch ends in the cell");
    add("parted", share(walked_.parted), "", "where play and the model are in different branches");
  }

  void add_errors(const std::string& of, const std::string& unit, double PlayError::*error,
                  const WorstError& worst) {
    const std::vector<double> values = column(walked_.one_branch, error);
    add(of + " median", quantile(values, 0.5), unit);
    add(of + " 99 %", quantile(values, kMostPlaces), unit);
    add(of + " worst", worst.value, unit, worst.where);
  }

  void add_estimate() {
    const auto coarse = column(walked_.one_branch, &PlayError::coarse_state, true);
    const double e = quantile(column(walked_.one_branch, &PlayError::state, true), kMostPlaces);
    const double twice = quantile(coarse, kMostPlaces);
    if (coarse.size() < kLeastPlaces || !(e > 0)) return;
    const double order = std::log2(twice / e);
    const double median = quantile(column(walked_.one_branch, &PlayError::state, true), 0.5);
    if (median > 0)
      add("median order", std::log2(quantile(coarse, 0.5) / median), "",
          "how the median falls, as the next line says of the 99 %");
    add("order", order, "",
        format("of the 99 %, which is {} with every other point, and here {} in the same places",
               rounded(twice), rounded(e)));
    if (!wanted_ || !(order > kLeastOrder)) {
      if (wanted_) check_.figures.back().where += "; too low to tell a sufficient spacing";
      return;
    }
    const double now = quantile(column(walked_.one_branch, &PlayError::state), kMostPlaces);
    const double spacing =
        spec_.box.spacing * std::pow(*wanted_ / now, 1 / std::min(order, kHighestOrder));
    add("sufficient spacing", spacing, spec_.length_unit,
        format("{}, for {} in 99 of 100 places", points_text(spec_.box, spacing),
               rounded(*wanted_)));
  }

  void judge() {
    check_.found.offenders = walked_.failed.offenders;
    check_.found.first = walked_.failed.first;
    if (!wanted_) {
      check_.meaning = "conversions that failed on the way";
      return;
    }
    const std::vector<double> errors = column(walked_.one_branch, &PlayError::state);
    check_.meaning = "places with an error above " + rounded(*wanted_) +
                     ", where these are more than 1 in 100; and conversions that failed";
    if (quantile(errors, kMostPlaces) <= *wanted_) return;
    check_.found.offenders += static_cast<std::uint64_t>(
        std::count_if(errors.begin(), errors.end(), [&](double e) { return e > *wanted_; }));
    auto& first = check_.found.first;
    first.insert(first.begin(),
                 {format("off by {} {}", rounded(walked_.state.value), walked_.state.where)});
    first.resize(std::min(first.size(), Findings::kShown));
  }

  const GridSpec& spec_;
  const Walked& walked_;
  const bool has_force_;
  const std::optional<double> wanted_;
  Check check_{"accurate", "places", "", {}};
};

}  // namespace

Check check_accurate(const GridSpec& spec, const Walked& walked, bool has_force,
                     std::optional<double> wanted) {
  return Row(spec, walked, has_force, wanted).check();
}

}  // namespace hapgrid
