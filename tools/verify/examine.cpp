#include "tools/verify/examine.hpp"

#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include "libcore/base/format.hpp"
#include "libcore/check/accuracy.hpp"
#include "libcore/check/fidelity.hpp"
#include "libcore/check/gradient.hpp"
#include "libcore/check/invariants.hpp"
#include "libcore/check/passive.hpp"
#include "libcore/check/snaps.hpp"
#include "libcore/check/steep.hpp"
#include "libcore/model/model.hpp"
#include "libcore/search/converter.hpp"
#include "tools/common/node_forces.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/traversals.hpp"

namespace hapgrid {

namespace {

constexpr std::uint64_t kSample = 1;  // the seed of what is drawn, which is the same each time

/// A line that counts up to `all` while there is one to show it.
ProgressLine progress_of(const char* row, const std::atomic<std::uint64_t>& done, std::uint64_t all,
                         const char* unit) {
  return ProgressLine([=, &done](double seconds) {
    const double part =
        static_cast<double>(done) / static_cast<double>(std::max<std::uint64_t>(all, 1));
    return format("verify: {}, {}: {} of {} {}", part_done(part, part / std::max(seconds, 1e-3)),
                  row, done.load(), all, unit);
  });
}

Check recompute_conversions(const Grid& grid, std::span<const RecordIndex> sample,
                            const MakeModel& model, int threads) {
  std::atomic<std::uint64_t> done{0};
  const ProgressLine progress = progress_of("fidelity", done, sample.size(), "records");
  return check_fidelity(grid, sample, model, threads, done);
}

/// The row `passive`, for the force that play sends.
/// @param gradient its row @param make_model of a model that may be asked where it snaps; empty: it
/// may not
Check prove_passive(const Grid& grid, const BranchNodes& branches, const RecordFields& fields,
                    const Check& gradient, const MakeModel& make_model, int threads) {
  const NodeForces forces = node_forces(grid, fields);
  const bool is_known = gradient.verdict() == "broken" || !gradient.remark.empty();
  if (!forces.has_energy())
    return passive_not_proved(
        format("play interpolates the forces of the records, which have no energy, because {}; "
               "make the grid finer, or give the model the energy of its force: see check-model",
               is_known ? gradient.meaning : forces.why_not));
  add_ghosts(*forces.nodes, grid, branches);
  return check_passive(grid, branches, *forces.nodes, make_model, threads);
}

Check measure_accuracy(const Grid& grid, const Examination& asked, const MakeModel& make_model,
                       bool knows_force) {
  std::atomic<std::uint64_t> done{0};
  const ProgressLine progress = progress_of("accurate", done, asked.walks, "walks");
  const Walked walked = walk_grid(grid, asked.walks, kSample, make_model,
                                  traversals(kDefaultRule, grid, make_model), asked.threads, done);
  return check_accurate(grid.spec(), walked, knows_force, asked.accuracy);
}

}  // namespace

std::vector<Check> examine(const Grid& grid, const Examination& asked) {
  const GridSpec& spec = grid.spec();
  std::unique_ptr<ModelSource> source;
  if (asked.recompute > 0 || asked.walks > 0)
    source = model_source(spec, asked.model,
                          asked.walks > 0 ? " (or leave C out: --recompute none, and no --walks)"
                                          : " (or leave C out: --recompute none)");
  // A model that is asked for forces and for equality, and never for a conversion.
  const auto judge = [&] { return judging_model(spec); };
  const auto make_model = [&] { return create_model(*source, spec); };
  const std::unique_ptr<Model> judging = judge();
  const bool knows_force = Fields(spec, *judging).has_force();
  const auto is_stored = spec.row_size() > grid.state_size();

  std::vector<Check> checks;
  const auto add = [&](Check&& check) { checks.push_back(std::move(check)); };

  // Is it complete?
  add(check_complete(grid));
  add(check_coverage(grid));
  add(check_links(grid));
  add(check_finite(grid));
  add(check_distinct(grid, *judging));
  const std::vector<std::uint32_t> distances = find_distances(grid);
  add(check_reachable(grid, distances));
  add(check_generations(grid, distances));

  // Is it what the model says?
  std::vector<RecordIndex> sample;
  if (asked.recompute > 0) {
    sample = sample_records(grid, asked.recompute, kSample);
    add(recompute_conversions(grid, sample, make_model, asked.threads));
    if (is_stored) add(check_stored(grid, sample, make_model, asked.threads));
    add(check_stable(grid, sample, make_model, asked.threads));
    add(check_snaps(grid, sample, make_model, asked.threads));
  }

  // What does the hand feel?
  const BranchNodes branches(grid);
  add(check_continuous(grid, branches));
  RecordFields fields;
  if (knows_force) fields = record_fields(grid, judge, asked.threads);
  Check gradient;
  if (!fields.energy.empty()) {
    gradient = check_gradient(grid, fields, sample, asked.recompute > 0 ? make_model : MakeModel());
    add(Check(gradient));
  }
  add(check_steep(grid, fields.force));
  if (knows_force)
    add(prove_passive(grid, branches, fields, gradient,
                      asked.recompute > 0 ? MakeModel(make_model) : MakeModel(), asked.threads));

  // And between the points?
  if (asked.walks > 0) add(measure_accuracy(grid, asked, make_model, knows_force));
  return checks;
}

}  // namespace hapgrid
