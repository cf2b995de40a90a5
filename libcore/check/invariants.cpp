#include "libcore/check/invariants.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "libcore/base/text.hpp"
#include "libcore/check/neighbour_checks.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/grid/record_order.hpp"
#include "libcore/shard/chunks.hpp"
#include "libcore/shard/load.hpp"

namespace hapgrid {

bool is_finite(std::span<const double> state) {
  return std::all_of(state.begin(), state.end(), [](double v) { return std::isfinite(v); });
}

namespace {

/// The records as they come: what can be said of one record, or of the levels of one point, at
/// once; the rest when all neighbours have come.
class Invariants {
 public:
  /// @param spec and `same` outlive this. @param generation of the grid
  Invariants(const GridSpec& spec, std::uint32_t generation, bool has_tears, const SameState& same)
      : spec_(spec), generation_(generation), same_(same), around_(spec, generation, has_tears) {}

  void add(const RecordLinks& record, std::span<const double> row) {
    around_.add(record);
    ++complete_.found.counted;
    if (record.generation == generation_)
      complete_.found.offend({record.point, record.level, {}},
                             [&] { return describe(spec_.box, record.point, record.level); });
    check_finite(record.point, record.level, row);
    if (record.level == 0) {
      compare_levels();
      point_ = record.point;
      states_.clear();
    }
    states_.insert(states_.end(), row.begin(), row.begin() + spec_.state_size);
  }

  /// @param find_distances the rows `reachable` and `generations`, from the whole grid
  std::vector<Check> finish(const std::function<std::vector<Check>()>& find_distances) {
    compare_levels();
    around_.finish();
    std::vector<Check> checks{std::move(complete_), around_.coverage(), around_.links(),
                              std::move(finite_), std::move(distinct_)};
    if (around_.has_tears()) checks.push_back(around_.fractions());
    std::vector<Check> distances =
        around_.proves_distances() ? around_.distances() : find_distances();
    std::move(distances.begin(), distances.end(), std::back_inserter(checks));
    return checks;
  }

 private:
  void check_finite(PointIndex point, Level level, std::span<const double> row) {
    ++finite_.found.counted;
    if (is_finite(row)) return;
    finite_.found.offend({point, level, {}}, [&] {
      const auto bad =
          std::find_if_not(row.begin(), row.end(), [](double v) { return std::isfinite(v); });
      const auto index = static_cast<std::size_t>(bad - row.begin());
      const bool in_state = index < spec_.state_size;
      return describe(spec_.box, point, level) + ": " +
             (in_state ? "component " : "stored number ") +
             std::to_string(in_state ? index : index - spec_.state_size) + " is " + to_text(*bad);
    });
  }

  /// The levels of the point that has come last, with each other.
  void compare_levels() {
    const std::size_t size = spec_.state_size;
    const std::size_t levels = states_.size() / size;
    const auto state = [&](std::size_t level) {
      return std::span(states_).subspan(level * size, size);
    };
    for (std::size_t a = 0; a < levels; ++a)
      for (std::size_t b = a + 1; b < levels; ++b) {
        ++distinct_.found.counted;
        if (!is_finite(state(a)) || !is_finite(state(b))) continue;
        if (!same_(state(a).data(), state(b).data())) continue;
        const auto level = static_cast<Level>(a);
        distinct_.found.offend({point_, level, {}}, [&] {
          return describe(spec_.box, point_, level) + " and level " + std::to_string(b) +
                 ": states " + state_text(state(a)) + " and " + state_text(state(b));
        });
      }
  }

  const GridSpec& spec_;
  const std::uint32_t generation_;
  const SameState& same_;
  NeighbourChecks around_;
  Check complete_{"complete", "records", "records that no expand has looked at (the frontier)", {}};
  Check finite_{"finite", "records", "rows with a number that is not finite", {}};
  Check distinct_{"distinct",
                  "pairs of levels",
                  "levels of one point that are the same state under the tolerance function",
                  {}};
  PointIndex point_ = 0;
  std::vector<double> states_;  // of its levels so far
};

}  // namespace

std::vector<Check> check_invariants(const Grid& grid, const SameState& same) {
  Invariants invariants(grid.spec(), grid.generation(), grid.has_tears(), same);
  for (std::uint64_t p = 0; p < grid.box().points(); ++p) {
    const auto point = static_cast<PointIndex>(p);
    const RecordIndex first = grid.first(point);
    for (RecordIndex r = first; r < first + grid.levels(point); ++r)
      invariants.add({point, static_cast<Level>(r - first), grid.record_generation(r),
                      grid.links(r).data(), grid.has_tears() ? grid.tears(r).data() : nullptr},
                     grid.row(r));
  }
  return invariants.finish([&] { return check_reachable(grid); });
}

std::vector<Check> check_invariants(const Section& section, const SameState& same) {
  const SectionHeader& header = section.header;
  require_plausible(section);
  require_enough_records(header.spec.box, section.records());
  Invariants invariants(header.spec, header.generation, header.has_tears, same);
  SectionReader reader(section);
  RecordRows rows;
  const std::size_t width = header.spec.row_size();
  for (std::size_t i = 0; i < section.footer.chunks.size(); ++i) {
    reader.read(i, rows);
    for (std::size_t r = 0; r < rows.size(); ++r)
      invariants.add(
          {rows.point[r], rows.level[r], rows.generation[r], &rows.links[r * kDirections],
           header.has_tears ? &rows.tears[r * kDirections] : nullptr},
          std::span(rows.numbers).subspan(r * width, width));
  }
  return invariants.finish([&] { return check_reachable(load_grid(section).grid); });
}

}  // namespace hapgrid
