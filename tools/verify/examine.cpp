#include "tools/verify/examine.hpp"

#include <atomic>
#include <functional>
#include <memory>
#include <span>
#include <utility>

#include "libcore/check/configurations.hpp"
#include "libcore/check/fidelity.hpp"
#include "libcore/check/forces.hpp"
#include "libcore/check/invariants.hpp"
#include "libcore/check/passive.hpp"
#include "libcore/check/paths.hpp"
#include "libcore/model/model.hpp"
#include "libcore/search/converter.hpp"
#include "libcore/shard/load.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

class Examiner {
 public:
  explicit Examiner(const Examination& asked)
      : asked_(asked),
        loaded_(load_grid(asked.grid)),
        grid_(loaded_.grid),
        points_(asked.part.share(grid_.box().points())) {
    if (asked.recompute > 0 || asked.walks > 0)
      source_ = model_source(grid_.spec(), asked.model,
                             asked.walks > 0 ? " (or leave C out: --recompute none, and no --walks)"
                                             : " (or leave C out: --recompute none)");
    Model model = judge();
    has_force_ = has_force(grid_.spec(), model);
    same_ = model_functions(std::move(model)).same;
  }

  PartReport report() {
    report_.part = asked_.part;
    report_.digest = loaded_.digest;
    report_.grid = summary_of(grid_);
    report_.options = options();
    look_at_points();
    if (is_first()) add(check_reachable(grid_));
    if (asked_.recompute > 0) ask_model_again();
    report_.checks.push_back(check_blends(grid_, points_, asked_.threads));
    if (is_first()) look_at_configurations();
    if (asked_.walks > 0) walk();
    return std::move(report_);
  }

 private:
  bool is_first() const { return asked_.part.is_first(); }
  void add(std::vector<Check>&& checks) {
    for (Check& check : checks) report_.checks.push_back(std::move(check));
  }

  Model judge() const { return judging_model(grid_.spec(), asked_.model.path); }
  ModelFunctions make_model() const {
    return model_functions(create_model(*source_, grid_.spec()));
  }

  /// What parts must have in common beside the grid.
  nlohmann::ordered_json options() const {
    const Rendering& device = asked_.rendering;
    nlohmann::ordered_json options{{"--recompute", asked_.recompute},
                                   {"--sample-seed", asked_.sample_seed},
                                   {"--walks", asked_.walks},
                                   {"--accuracy", asked_.accuracy.value_or(0)},
                                   {"--damping", device.damping},
                                   {"--rate", device.rate_hz},
                                   {"--scale", device.scale.value_or(0)}};
    return options;
  }

  void look_at_points() {
    report_.checks.push_back(check_complete(grid_, points_, asked_.threads));
    report_.checks.push_back(check_coverage(grid_, points_, asked_.threads));
    report_.checks.push_back(check_links(grid_, points_, asked_.threads));
    report_.checks.push_back(check_finite(grid_, points_, asked_.threads));
    report_.checks.push_back(check_distinct(grid_, same_, points_));
  }

  void ask_model_again() {
    const auto all = sample_records(grid_, asked_.recompute, asked_.sample_seed);
    const Range share = asked_.part.share(all.size());
    const auto sample = std::span(all).subspan(share.begin, share.size());
    std::atomic<std::uint64_t> done{0};
    const ProgressLine progress(false, [&](double) {
      return "verify: fidelity: " + std::to_string(done) + " of " + std::to_string(sample.size()) +
             " records";
    });
    const auto model = [&] { return make_model(); };
    report_.checks.push_back(check_fidelity(grid_, sample, model, asked_.threads, done));
    if (grid_.spec().row_size() == grid_.state_size()) return;
    report_.checks.push_back(check_stored(grid_, sample, model, asked_.threads));
  }

  void look_at_configurations() {
    const CellMap map(grid_, asked_.threads);
    const Configurations found =
        find_configurations(grid_, map, asked_.threads, default_configuration_limit(map));
    add(check_paths(grid_, map, found, asked_.threads));
    std::optional<Forces> forces;
    if (has_force_)
      forces.emplace(
          grid_, [&] { return judge(); }, asked_.threads);
    report_.checks.push_back(check_steep(grid_, map, found, forces ? &*forces : nullptr,
                                         asked_.rendering, asked_.threads));
    if (!forces) return;
    report_.checks.push_back(check_passive(grid_, map, found, *forces, asked_.threads));
  }

  void walk() {
    const Range share = asked_.part.share(asked_.walks);
    WalkModels models{
        [&] { return make_model(); }, [&] { return model_functions(judge()).same; }, {}};
    if (has_force_)
      models.fields = [&] {
        return Fields(
            grid_.spec(), [&] { return judge(); }, false);
      };
    std::atomic<std::uint64_t> done{0};
    const ProgressLine progress(false, [&](double) {
      return "verify: accurate: " + std::to_string(done) + " of " + std::to_string(share.size()) +
             " walks";
    });
    report_.walked = walk_grid(grid_, share, asked_.sample_seed, models, asked_.threads, done);
    report_.terms = accuracy_terms(grid_.spec(), has_force_, asked_.accuracy);
  }

  const Examination& asked_;
  const LoadedGrid loaded_;
  const Grid& grid_;
  const Range points_;
  std::unique_ptr<ModelSource> source_;
  bool has_force_ = false;
  SameState same_;
  PartReport report_;
};

}  // namespace

PartReport examine(const Examination& asked) { return Examiner(asked).report(); }

}  // namespace hapgrid
