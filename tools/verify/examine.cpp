#include "tools/verify/examine.hpp"

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "libcore/check/accuracy.hpp"
#include "libcore/check/blended_energy.hpp"
#include "libcore/check/blends.hpp"
#include "libcore/check/branches.hpp"
#include "libcore/check/configurations.hpp"
#include "libcore/check/fidelity.hpp"
#include "libcore/check/forces.hpp"
#include "libcore/check/gradient.hpp"
#include "libcore/check/invariants.hpp"
#include "libcore/check/passive.hpp"
#include "libcore/check/paths.hpp"
#include "libcore/check/played_work.hpp"
#include "libcore/check/tears.hpp"
#include "libcore/check/trapezoid_work.hpp"
#include "libcore/model/model.hpp"
#include "libcore/search/converter.hpp"
#include "libcore/shard/chunks.hpp"
#include "tools/common/progress.hpp"

namespace hapgrid {

namespace {

// What a closed walk of the played force may gain a unit of length, in newtons, unless it is said.
// Where the energy is interpolated, only snaps can lead up, by what extrapolation is off: the
// friction of common devices takes more (Geomagic Touch: 0.26 N). Interpolated forces gain
// anywhere, and a loop of the hung ball with the wrong sign gains only 0.14 N; good devices have
// 0.04 N (Phantom Premium).
constexpr double kSnapFriction = 0.2;
constexpr double kForceFriction = 0.05;

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
    add(check_invariants(grid_, same_));
    if (asked_.recompute > 0) ask_model_again();
    add({check_blends(grid_, threads_)});
    if (has_force_)
      fields_.emplace(
          grid_.spec(), [&] { return judge(); }, false);
    say_energy([&] { return energy_of_blends(grid_, *fields_); });
    look_at_configurations();
    if (asked_.walks > 0) walk();
    return std::move(checks_);
  }

 private:
  void add(std::vector<Check>&& checks) {
    for (Check& check : checks) checks_.push_back(std::move(check));
  }

  /// Adds to the row `name`, or to the last one, how far blends leave their corners' energies.
  void say_energy(const std::function<BlendedEnergy()>& look, const std::string& name = "") {
    if (!fields_ || !can_ask_energy(grid_.spec(), *fields_)) return;
    for (Check& check : checks_) {
      if (name.empty() ? &check != &checks_.back() : check.name != name) continue;
      for (Figure& figure : look().figures(grid_.spec(), grid_.box()))
        check.figures.push_back(std::move(figure));
    }
  }

  /// A model that is asked for forces and for equality, and never for a conversion.
  std::unique_ptr<Model> judge() const { return judging_model(grid_.spec(), asked_.model.path); }
  ModelFunctions make_model() const {
    return model_functions(create_model(*source_, grid_.spec()));
  }

  void ask_model_again() {
    const auto sample = sample_records(grid_, asked_.recompute, asked_.sample_seed);
    std::atomic<std::uint64_t> done{0};
    const ProgressLine progress([&](double) {
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
    std::optional<BranchMap> branches;
    if (asked_.traversal == TraversalRule::kPaper) {
      add(check_paths(grid_, map, found, threads_));
      say_energy([&] { return energy_of_configurations(grid_, found, *fields_); }, "mixed");
    } else {
      branches.emplace(grid_);
      add({check_branches(grid_, branches->sheets, threads_)});
      say_energy([&] { return energy_of_branches(grid_, branches->sheets, *fields_); });
    }
    if (!has_force_) {
      add({check_steep(grid_, map, found, nullptr, asked_.rendering, threads_)});
      return;
    }
    const RecordFields fields = record_fields(
        grid_, [&] { return judge(); }, threads_);
    if (!fields.energy.empty()) add({check_gradient(grid_, fields)});
    const Forces forces(fields.force);
    add({check_steep(grid_, map, found, &forces, asked_.rendering, threads_)});
    const ForceRule rule = asked_.force.value_or(default_force(asked_.traversal));
    if (rule == ForceRule::kState || !branches)
      look_at_work_between_points(map, found, fields);
    else
      look_at_played_work(*branches, node_forces(rule, grid_, fields));
  }

  /// The rows `passive` and `limited` where the force between the points is not known.
  void look_at_work_between_points(const CellMap& map, const Configurations& found,
                                   const RecordFields& fields) {
    const auto limited = [&](const ForceLimit& limit) {
      std::vector<Vec3> forces = fields.force;
      for (Vec3& f : forces) f = limit(f);
      return Forces(std::move(forces));
    };
    const Forces felt = limited({asked_.limit.gain});
    const TrapezoidWork work(grid_, felt);
    const Energy energy = find_energy(grid_, work, threads_, Findings::kShown);
    Check check = check_passive(grid_, work, energy);
    if (asked_.traversal == TraversalRule::kPaper)
      add_inside_cells(check, grid_, map, found, felt, energy, threads_);
    add({std::move(check)});
    if (!asked_.limit.cuts()) return;
    const Forces cut = limited(asked_.limit);
    add({check_limited(grid_, asked_.limit,
                       find_energy(grid_, TrapezoidWork(grid_, cut), threads_, Findings::kShown))});
  }

  /// And where play interpolates it from the nodes.
  void look_at_played_work(const BranchMap& branches, const NodeForces& forces) {
    forces.nodes->add_ghosts(grid_, branches.sheets);
    const double tolerated = asked_.friction.value_or(
        forces.rule == ForceRule::kEnergy ? kSnapFriction : kForceFriction);
    const auto look_at = [&](const ForceLimit& limit, auto&& use) {
      const PlayedWork work(grid_, branches, *forces.nodes, forces.interpolate, limit, threads_);
      add({use(work, find_energy(grid_, work, threads_, Findings::kShown, tolerated))});
    };
    look_at({asked_.limit.gain}, [&](const Work& work, const Energy& energy) {
      return check_passive(grid_, work, energy);
    });
    if (asked_.limit.cuts())
      look_at(asked_.limit, [&](const Work&, const Energy& energy) {
        return check_limited(grid_, asked_.limit, energy);
      });
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
    const ProgressLine progress([&](double) {
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
  std::optional<Fields> fields_;  // where there is a force
  SameState same_;
  std::vector<Check> checks_;
};

}  // namespace

std::vector<Check> examine(const Grid& grid, const Examination& asked) {
  return Examiner(grid, asked).checks();
}

std::vector<Check> examine_invariants(const Section& section, const ModelOptions& model) {
  SameState same;
  try {
    same = model_functions(judging_model(section.header.spec, model.path)).same;
  } catch (...) {
    // In a damaged shard the damage is the reason; else it is the model.
    for_each_chunk(section, [](std::size_t, std::uint64_t, const RecordRows&) {});
    throw;
  }
  return check_invariants(section, same);
}

}  // namespace hapgrid
