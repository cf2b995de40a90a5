#include "tools/check-model/remarks.hpp"

#include <algorithm>
#include <string>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

// Newtons. A hand at a device notices some hundredths.
constexpr double kLeastFelt = 1e-3;
// Of the tolerance: what is exact enough that no two records can be confused.
constexpr double kExact = 0.1;
// Of a model that leaps at one snap in four, as many pass with a probability of 0.05.
constexpr std::uint64_t kEnoughSnaps = 10;
constexpr std::size_t kMostLooks = 64;  // at the memory; of more, every other one is forgotten
constexpr std::size_t kFewestLooks = 8;
// A model grows that took, in the second half of the walks, as much again as in the first, less
// what caches and the heap are filled with; and more than what check-model keeps for a step itself.
constexpr double kAsMuchAgain = 0.6;
constexpr std::uint64_t kOwnBytes = 2048;
constexpr std::uint64_t kLeastBytes = 4 << 20;

}  // namespace

std::optional<Check> note_felt(bool has_force, double largest_newtons, std::uint64_t forces) {
  if (has_force && (forces == 0 || largest_newtons >= kLeastFelt)) return std::nullopt;
  Check note{
      "felt",
      "models",
      "a model without a force: nothing of its grid can be felt, and play refuses it. Give it "
      "a force function; \"stored\" of a process must name it",
      {1, 1, {}},
      /*is_note=*/true};
  if (has_force)
    note.meaning = format("the largest of {} forces is {} N, which nobody feels: {}", forces,
                          rounded(largest_newtons),
                          largest_newtons > 0 ? "is it in newtons, and force_scale right?"
                                              : "does the force function do anything?");
  note.remark = "nothing can be felt";
  return note;
}

std::optional<Check> note_spread(const std::vector<double>& distances, const GridSpec& spec) {
  Check note{"spread", "states", "", {}, /*is_note=*/true};
  note.found.counted = distances.size();
  double largest = 0;
  for (const double distance : distances)
    if (distance > kExact * spec.tolerance) {
      ++note.found.offenders;
      largest = std::max(largest, distance);
    }
  // As many may be near a place where the model snaps.
  if (note.found.offenders * 100 <= note.found.counted) return std::nullopt;
  const std::string unit =
      spec.tolerance_unit.empty() ? "" : " " + printable_line(spec.tolerance_unit);
  note.meaning = format(
      "states that count as the same are up to {}{} apart, more than a tenth of the tolerance, "
      "{}{}: C is not exact, or the tolerance is so wide that different states are taken for one",
      rounded(largest), unit, rounded(spec.tolerance), unit);
  note.remark = format(
      "the tolerance is too wide, or C not exact: the same states are up to {}{} "
      "apart",
      rounded(largest), unit);
  return note;
}

void MemoryLog::add(std::uint64_t steps, std::uint64_t bytes) {
  if (bytes > 0) looks_.push_back({steps, bytes});
  if (looks_.size() < kMostLooks) return;
  for (std::size_t i = 0; 2 * i < looks_.size(); ++i) looks_[i] = looks_[2 * i];
  looks_.resize(looks_.size() / 2);
  every_ *= 2;
}

std::optional<Check> MemoryLog::note() const {
  if (looks_.size() < kFewestLooks) return std::nullopt;
  const Look &first = looks_[looks_.size() / 8], &middle = looks_[looks_.size() * 9 / 16],
             &last = looks_.back();
  const auto grown = [](const Look& from, const Look& to) {
    return to.bytes > from.bytes ? static_cast<double>(to.bytes - from.bytes) : 0;
  };
  const double again = grown(middle, last);
  if (again < static_cast<double>(kLeastBytes + kOwnBytes * (last.steps - middle.steps)) ||
      again < kAsMuchAgain * grown(first, middle))
    return std::nullopt;
  const auto whole = [](double x) { return static_cast<std::uint64_t>(x); };
  Check note{"memory", "models", "", {1, 1, {}}, /*is_note=*/true};
  note.meaning = format(
      "the model's memory grows as long as it is asked, by {} in {} steps of the walks: does it "
      "keep what it should give back? The search asks far more",
      megabytes(whole(grown(first, last))), last.steps - first.steps);
  note.remark = "the model's memory grows";
  return note;
}

std::string remark_on_snaps(const Findings& snaps) {
  if (snaps.counted == 0 || snaps.counted >= kEnoughSnaps) return "";
  return format("only {} snap{} seen; --steps N sees more", snaps.counted,
                snaps.counted == 1 ? " was" : "s were");
}

}  // namespace hapgrid
