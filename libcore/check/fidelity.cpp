#include "libcore/check/fidelity.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <utility>

#include "libcore/base/format.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/base/random.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/model/state_distance.hpp"

namespace hapgrid {

namespace {

// Records that a thread takes at once: up to 1664 conversions, so that the shared counter costs
// nothing, and still few enough to keep all threads busy until the end with a slow model.
constexpr std::size_t kSampleBlock = 64;

// The search evaluates force and shape at x + d, this at the point's own position: half a unit in
// the last place of x apart. The stiffest contacts make 1e-10 of a force of that; the bound leaves
// room for models that are computed less exactly, and a number that is wrong differs by far more.
constexpr double kStoredTolerance = 1e-6;

// Of the spacing: a step that makes C look for a minimum, and that hardly any state snaps in.
constexpr double kNudge = 1e-6;
// Of the distance by which a state was pushed. One that comes back ends at 0, and where friction
// holds it at 1; one that ends far beyond has fallen into another basin.
constexpr double kFallen = 3;

/// Whether the link in direction q of a record can be compared.
bool is_settled(const Grid& grid, RecordIndex r, int q) {
  const RecordIndex target = grid.destination(r, q);
  return target != Grid::kNoRecord && is_finite(grid.state(target));
}

/// Evaluates all conversions of a record that can be compared: rows and errors by direction.
void convert_record(const Grid& grid, RecordIndex r, Model& model, double* rows,
                    std::string* errors) {
  int q = -1;
  model.convert_all(
      [&](Conversion& conversion, bool) {
        do ++q;
        while (q < kDirections && !is_settled(grid, r, q));
        if (q >= kDirections) {
          q = kDirections - 1;  // the model may ask once more
          return false;
        }
        conversion = {grid.state(r).data(), grid.box().position(grid.point(r)),
                      grid.neighbourhood().shift(q),
                      rows + static_cast<std::size_t>(q) * grid.spec().row_size(),
                      static_cast<std::uint64_t>(q)};
        return true;
      },
      [&](const Conversion& conversion, std::string_view error) {
        errors[conversion.tag] = error;
      });
}

void recompute(const Grid& grid, RecordIndex r, Model& model, std::vector<double>& rows,
               Findings& found) {
  if (!is_finite(grid.state(r))) return;
  rows.resize(std::size_t{kDirections} * grid.spec().row_size());
  std::string errors[kDirections];
  convert_record(grid, r, model, rows.data(), errors);
  for (int q = 0; q < kDirections; ++q) {
    if (!is_settled(grid, r, q)) continue;
    const RecordIndex target = grid.destination(r, q);
    const double* const reached = &rows[static_cast<std::size_t>(q) * grid.spec().row_size()];
    ++found.counted;
    if (!errors[q].empty()) {
      found.offend(at_link(grid, r, q), [&] {
        return format("{}: conversion failed: {}", describe_link(grid, r, q), errors[q]);
      });
    } else if (!model.equal(reached, grid.state(target).data())) {
      found.offend(at_link(grid, r, q), [&] {
        return format("{}: C gives {}, stored at level {} is {}", describe_link(grid, r, q),
                      state_text(std::span(reached, grid.state_size())), grid.level(target),
                      state_text(grid.state(target)));
      });
    }
  }
}

void recompute_stored(const Grid& grid, RecordIndex r, Model& model, std::vector<double>& row,
                      Findings& found) {
  if (!is_finite(grid.row(r))) return;
  row.resize(grid.spec().row_size());
  ++found.counted;
  const std::size_t n = grid.state_size();
  std::copy_n(grid.state(r).begin(), n, row.begin());
  if (!model.complete(grid.box().position(grid.point(r)), row.data()))
    return found.offend(at_record(grid, r),
                        [&] { return describe(grid, r) + ": " + model.error(); });
  for (std::size_t i = n; i < row.size(); ++i) {
    const double stored = grid.row(r)[i];
    if (std::abs(row[i] - stored) <= kStoredTolerance * std::max(1.0, std::abs(stored))) continue;
    return found.offend(at_record(grid, r), [&] {
      return format("{}: stored number {} is {}, the model gives {}", describe(grid, r), i - n,
                    to_text(stored), to_text(row[i]));
    });
  }
}

void push(const Grid& grid, RecordIndex r, Model& model, std::vector<double>&, Findings& found) {
  if (!is_finite(grid.state(r))) return;
  ++found.counted;
  const std::string where =
      falls_away(model, grid.spec(), grid.state(r), grid.box().position(grid.point(r)));
  if (!where.empty())
    found.offend(at_record(grid, r), [&] { return describe(grid, r) + ": " + where; });
}

/// Runs work_on(grid, record, model, numbers, findings) for all records, in threads. Findings are
/// kept by block and joined in order, so that the threads leave no trace.
template <class Work>
Findings for_each_record(const Grid& grid, std::span<const RecordIndex> records,
                         const MakeModel& make_model, int threads,
                         std::atomic<std::uint64_t>& records_done, Work&& work_on) {
  std::vector<Findings> blocks((records.size() + kSampleBlock - 1) / kSampleBlock);
  const std::vector<std::unique_ptr<Model>> models = make_models(make_model, threads);
  for_each_with_own(blocks.size(), models, [&](const std::unique_ptr<Model>& model, std::size_t b) {
    std::vector<double> numbers;
    const std::size_t end = std::min(records.size(), (b + 1) * kSampleBlock);
    for (std::size_t i = b * kSampleBlock; i < end; ++i)
      work_on(grid, records[i], *model, numbers, blocks[b]);
    records_done += end - b * kSampleBlock;
  });
  return sum_of(std::move(blocks));
}

}  // namespace

std::vector<RecordIndex> sample_records(const Grid& grid, std::uint64_t count, std::uint64_t seed) {
  std::vector<RecordIndex> records;
  for (RecordIndex r = 0; r < grid.records(); ++r)
    if (!grid.in_frontier(r)) records.push_back(r);
  if (count >= records.size()) return records;
  // Floyd's algorithm (Bentley, Floyd: CACM 30 (1987) 754): each subset with the same probability,
  // from `count` random numbers.
  SplitMix64 random(seed);
  std::vector<bool> is_chosen(records.size());
  for (std::uint64_t last = records.size() - count; last < records.size(); ++last) {
    const std::uint64_t pick = random.below(last + 1);
    is_chosen[is_chosen[pick] ? last : pick] = true;
  }
  std::vector<RecordIndex> sample;
  sample.reserve(count);
  for (std::size_t i = 0; i < records.size(); ++i)
    if (is_chosen[i]) sample.push_back(records[i]);
  return sample;
}

Check check_fidelity(const Grid& grid, std::span<const RecordIndex> records,
                     const MakeModel& make_model, int threads,
                     std::atomic<std::uint64_t>& records_done) {
  Check check{
      "fidelity",
      "conversions",
      "links to a state that C, evaluated again, does not reach: if the model was changed since, "
      "give it another version and search again",
      {}};
  check.found = for_each_record(grid, records, make_model, threads, records_done, recompute);
  return check;
}

std::string falls_away(Model& model, const GridSpec& spec, std::span<const double> s,
                       const Vec3& x) {
  const Vec3 nudge{kNudge * spec.box.spacing, 0, 0};
  std::string where;
  for (const double side : {1.0, -1.0}) {
    SplitMix64 random(1);
    std::vector<double> pushed(s.begin(), s.end()), beside(spec.row_size()), ended(beside);
    for (double& component : pushed)
      component += side * kPush * spec.tolerance * (random.below(2) ? 1 : -1);
    orthonormalise_rotations(spec.equality, pushed);
    if (!model.convert(pushed.data(), x, nudge, beside.data()) ||
        !model.convert(beside.data(), x + nudge, -1 * nudge, ended.data()) ||
        model.equal(ended.data(), s.data()) ||
        state_distance(model, ended, s) < kFallen * state_distance(model, pushed, s))
      return "";
    where +=
        (where.empty() ? "falls to " : " and to ") + state_text(std::span(ended).first(s.size()));
  }
  return where;
}

Check check_stable(const Grid& grid, std::span<const RecordIndex> records,
                   const MakeModel& make_model, int threads) {
  Check check{
      "stable",
      "records",
      "states that are not at rest, as on the top of a barrier: pushed, they do not come back",
      {}};
  std::atomic<std::uint64_t> records_done{0};
  check.found = for_each_record(grid, records, make_model, threads, records_done, push);
  check.is_note = check.found.offenders > 0 && static_cast<double>(check.found.offenders) <=
                                                   kFew * static_cast<double>(check.found.counted);
  return check;
}

Check check_stored(const Grid& grid, std::span<const RecordIndex> records,
                   const MakeModel& make_model, int threads) {
  Check check{"stored",
              "records",
              "forces, energies or shapes that the model, asked again, does not give",
              {}};
  std::atomic<std::uint64_t> records_done{0};
  check.found = for_each_record(grid, records, make_model, threads, records_done, recompute_stored);
  return check;
}

}  // namespace hapgrid
