#include "libcore/check/snaps.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <string>
#include <utility>

#include "libcore/base/format.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/base/text.hpp"
#include "libcore/check/invariants.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/model/state_distance.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kMostLinks = 256;  // each costs kPieces conversions
// A snap that ends elsewhere in pieces ends elsewhere for a hand that moves slowly. That is right
// at a fork, where the smallest difference decides between two branches, and such places are rare:
// in nine of ten snaps the hand must get what the grid has. A few steps are no sample: there one or
// two are allowed, whatever their share is.
constexpr double kForks = 0.1;
constexpr double kFewForks = 2;
// Of the tolerance. Two states that are off by so much, to either side, are a whole tolerance
// apart: merge would take the same state for two levels.
constexpr double kWide = 0.5;

bool are_few(const Findings& found) {
  return static_cast<double>(found.offenders) <=
         std::max(kFewForks, kForks * static_cast<double>(found.counted));
}

using Link = std::pair<RecordIndex, int>;  ///< a record and a direction

/// @param is_wanted says of a link whether it is one
template <class IsWanted>
std::vector<Link> links_of(const Grid& grid, std::span<const RecordIndex> records,
                           const IsWanted& is_wanted, bool one_each) {
  std::vector<Link> links;
  for (const RecordIndex r : records)
    for (int k = 0; k < kDirections; ++k) {
      const int q = static_cast<int>((r + static_cast<RecordIndex>(k)) % kDirections);
      const RecordIndex to = grid.destination(r, q);
      if (to == Grid::kNoRecord || !is_wanted(r, q) || !is_finite(grid.state(r)) ||
          !is_finite(grid.state(to)))
        continue;
      links.emplace_back(r, q);
      if (one_each) break;
    }
  return links;
}

/// Every k-th of them, so that `most` are left.
std::vector<Link> thinned(const std::vector<Link>& links, std::size_t most) {
  if (links.size() <= most) return links;
  std::vector<Link> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(links[i * links.size() / most]);
  return some;
}

}  // namespace

std::optional<bool> convert_in_pieces(Model& model, std::span<const double> s, const Vec3& x,
                                      const Vec3& d, std::vector<double>& row,
                                      const std::function<bool()>& is_late) {
  row.assign(s.begin(), s.begin() + model.state_size());
  row.resize(model.row_size());
  std::vector<double> next(row.size());
  for (int k = 0; k < kPieces; ++k) {
    if (is_late && is_late()) return std::nullopt;
    const double part = 1.0 / kPieces;
    if (!model.convert(row.data(), x + (k * part) * d, part * d, next.data())) return false;
    row.swap(next);
  }
  return true;
}

void judge_halves(Check& check, std::vector<double> apart, const GridSpec& spec) {
  check.is_note = are_few(check.found);
  if (check.is_note) return;
  const auto middle = apart.begin() + static_cast<std::ptrdiff_t>(apart.size() / 2);
  std::nth_element(apart.begin(), middle, apart.end());
  check.meaning = format(
      "a step in two halves ends in another state, {} apart in the median; the tolerance is {}: "
      "C is less exact than that, or walks too coarsely. Let it converge (a smaller fmax, or "
      "tolerance of the gradient), or raise the tolerance",
      rounded(*middle), rounded(spec.tolerance));
}

void judge_snaps(Check& check) {
  check.is_note = are_few(check.found);
  check.meaning = format(
      "steps along which the model snaps, and which end in another state when they are made in {} "
      "pieces: C leaps over barriers that are still there, or is less exact than its tolerance. "
      "Make its steps of the HIP smaller, and go downhill by a descent that cannot leap, such as "
      "hapgrid.relax() in Python",
      kPieces);
}

Figure exactness(std::vector<double> distances, const GridSpec& spec) {
  const std::string unit = spec.tolerance_unit;
  const std::string tolerance =
      format("{}{}{}", rounded(spec.tolerance), unit.empty() ? "" : " ", printable_line(unit));
  double spread = 0;
  if (!distances.empty()) {
    const auto at =
        distances.begin() + static_cast<std::ptrdiff_t>((distances.size() - 1) * 99 / 100);
    std::nth_element(distances.begin(), at, distances.end());
    spread = *at;
  }
  std::string where = format(
      "99 % of the states that count as the same are this near; the tolerance is {}", tolerance);
  if (spread > kWide * spec.tolerance)
    where += ". C should be more exact: end its minimisation later, or raise the tolerance";
  return {"spread", spread, unit, where};
}

Check check_snaps(const Grid& grid, std::span<const RecordIndex> records,
                  const MakeModel& make_model, int threads) {
  const auto one_way = [&](RecordIndex r, int q) { return grid.is_one_way(r, q); };
  const auto two_way = [&](RecordIndex r, int q) { return grid.two_way(r, q) != Grid::kNoRecord; };
  // Snaps are rare, so they are sampled for themselves: a few records would have none.
  std::vector<RecordIndex> all(grid.records());
  std::iota(all.begin(), all.end(), RecordIndex{0});
  const std::vector<Link> snaps =
      thinned(links_of(grid, all, one_way, false), std::min(kMostLinks, 2 * records.size()));
  const std::vector<Link> others = links_of(grid, records, two_way, true);
  std::vector<std::string> elsewhere(snaps.size());
  std::vector<double> distances(others.size(), -1);
  const std::vector<std::unique_ptr<Model>> models = make_models(make_model, threads);
  const std::size_t work = snaps.size() + others.size();
  for_each_with_own(work, models, [&](const std::unique_ptr<Model>& model, std::size_t i) {
    const auto [r, q] = i < snaps.size() ? snaps[i] : others[i - snaps.size()];
    const std::span<const double> there = grid.state(grid.destination(r, q));
    const Vec3 x = grid.box().position(grid.point(r)), d = grid.neighbourhood().shift(q);
    std::vector<double> row(grid.spec().row_size());
    // Where C does not give what is stored, `fidelity` says so.
    if (!model->convert(grid.state(r).data(), x, d, row.data()) ||
        !model->equal(row.data(), there.data()))
      return;
    if (i >= snaps.size()) {
      distances[i - snaps.size()] = state_distance(*model, row, there);
    } else if (!*convert_in_pieces(*model, grid.state(r), x, d, row)) {
      elsewhere[i] = model->error();
    } else if (!model->equal(row.data(), there.data())) {
      elsewhere[i] = format("at once {}, in {} pieces {}", state_text(there), kPieces,
                            state_text(std::span(row).first(grid.state_size())));
    }
  });
  Check check{"snaps", "one-way links", "", {}};
  check.found.counted = snaps.size();
  for (std::size_t i = 0; i < snaps.size(); ++i) {
    if (elsewhere[i].empty()) continue;
    const Link& link = snaps[i];
    check.found.offend(at_link(grid, link.first, link.second), [&] {
      return describe_link(grid, link.first, link.second) + ": " + elsewhere[i];
    });
  }
  std::erase(distances, -1);
  judge_snaps(check);
  check.figures = {exactness(std::move(distances), grid.spec())};
  return check;
}

}  // namespace hapgrid
