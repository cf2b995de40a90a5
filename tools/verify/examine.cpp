#include "tools/verify/examine.hpp"

#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include "libcore/check/accuracy.hpp"
#include "libcore/check/branches.hpp"
#include "libcore/check/configurations.hpp"
#include "libcore/check/fidelity.hpp"
#include "libcore/check/forces.hpp"
#include "libcore/check/gradient.hpp"
#include "libcore/check/invariants.hpp"
#include "libcore/check/passive.hpp"
#include "libcore/check/paths.hpp"
#include "libcore/check/tears.hpp"
#include "libcore/model/model.hpp"
#include "libcore/search/converter.hpp"
#include "tools/common/progress.hpp"

namespace hapgrid {

namespace {

class Examiner {
 public:
  Examiner(const Grid& grid, const Examination& asked)
      : asked_(asked), grid_(grid), threads_(asked.threads) {
    if (asked.recompute > 0 || asked.walks > 0)
      source_ = model_source(grid_.spec(), asked.model,
                             asked.walks > 0 ? " (or leave C out: --recompute none, and no --walks)"
                                             : " (or leave C out: --recompute none)");
    std::unique_ptr<Model> model = judge();
    has_force_ = has_force(grid_.spec(), *model);
    same_ = model_functions(std::move(model)).same;
  }

  std::vector<Check> checks() {
    add({check_complete(grid_, threads_), check_coverage(grid_, threads_),
         check_links(grid_, threads_), check_finite(grid_, threads_),
         check_distinct(grid_, same_)});
    if (grid_.has_tears()) add({check_fractions(grid_)});
    add(check_reachable(grid_));
    if (asked_.recompute > 0) ask_model_again();
    add({check_blends(grid_, threads_)});
    look_at_configurations();
    if (asked_.walks > 0) walk();
    return std::move(checks_);
  }

 private:
  void add(std::vector<Check>&& checks) {
    for (Check& check : checks) checks_.push_back(std::move(check));
  }

  /// A model that is asked for forces and for equality, and never for a conversion.
  std::unique_ptr<Model> judge() const { return judging_model(grid_.spec(), asked_.model.path); }
  ModelFunctions make_model() const {
    return model_functions(create_model(*source_, grid_.spec()));
  }

  void ask_model_again() {
    const auto sample = sample_records(grid_, asked_.recompute, asked_.sample_seed);
    std::atomic<std::uint64_t> done{0};
    const ProgressLine progress(false, [&](double) {
      return "verify: fidelity: " + std::to_string(done) + " of " + std::to_string(sample.size()) +
             " records";
    });
    const auto model = [&] { return make_model(); };
    add({check_fidelity(grid_, sample, model, threads_, done)});
    if (grid_.spec().row_size() > grid_.state_size())
      add({check_stored(grid_, sample, model, threads_)});
    if (!grid_.has_tears()) return;
    Progress conversions;
    Converter converter(*source_, grid_.spec(), static_cast<unsigned>(threads_), conversions);
    add({check_tears(grid_, sample, converter)});
  }

  void look_at_configurations() {
    const CellMap map(grid_, threads_);
    const Configurations found =
        find_configurations(grid_, map, threads_, default_configuration_limit(map));
    if (asked_.traversal == TraversalRule::kPaper)
      add(check_paths(grid_, map, found, threads_));
    else
      add({check_branches(grid_, Sheets(grid_), threads_)});
    std::optional<Forces> forces;
    if (has_force_) {
      RecordFields fields = record_fields(
          grid_, [&] { return judge(); }, threads_);
      if (!fields.energy.empty()) add({check_gradient(grid_, fields)});
      forces.emplace(std::move(fields.force));
    }
    add({check_steep(grid_, map, found, forces ? &*forces : nullptr, asked_.rendering, threads_)});
    if (forces) add({check_passive(grid_, map, found, *forces, threads_)});
  }

  void walk() {
    WalkModels models{
        [&] { return make_model(); },
        [&] { return model_functions(judge()).same; },
        {},
        traversals(asked_.traversal, grid_, [&] { return create_model(*source_, grid_.spec()); })};
    if (has_force_)
      models.fields = [&] {
        return Fields(
            grid_.spec(), [&] { return judge(); }, false);
      };
    std::atomic<std::uint64_t> done{0};
    const ProgressLine progress(false, [&](double) {
      return "verify: accurate: " + std::to_string(done) + " of " + std::to_string(asked_.walks) +
             " walks";
    });
    const Walked walked =
        walk_grid(grid_, asked_.walks, asked_.sample_seed, models, threads_, done);
    add({check_accurate(walked, accuracy_terms(grid_.spec(), has_force_, asked_.accuracy))});
  }

  const Examination& asked_;
  const Grid& grid_;
  const int threads_;
  std::unique_ptr<ModelSource> source_;
  bool has_force_ = false;
  SameState same_;
  std::vector<Check> checks_;
};

}  // namespace

std::vector<Check> examine(const Grid& grid, const Examination& asked) {
  return Examiner(grid, asked).checks();
}

}  // namespace hapgrid
