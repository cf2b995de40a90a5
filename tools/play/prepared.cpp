#include "tools/play/prepared.hpp"

#include <utility>

#include "libcore/check/invariants.hpp"
#include "libcore/model/plugin_model.hpp"
#include "libcore/search/converter.hpp"
#include "tools/play/beside.hpp"

namespace hapgrid {

namespace {

Grid playable(const Section& section) {
  Grid grid = load_grid(section);
  require_playable(grid, section.file->name());
  return grid;
}

}  // namespace

PlayedGrid::PlayedGrid(const Section& section, const ModelOptions& options)
    : digest(section.name()),
      grid(playable(section)),
      create([this] { return Plugin(spec().model, model_path()).create(spec().parameters); }),
      create_exact(
          [this, options] { return create_model(*model_source(spec(), options), spec()); }),
      fields(spec(), create, /*wants_shape=*/false) {}

Follower::Follower(const PlayedGrid& grid, TraversalRule rule, const std::string& wanted, bool must,
                   bool live)
    : records_(PlayForce::ask_records(rule, grid.grid, grid.create)),
      traversal(traversals(rule, grid.grid, grid.create_exact)()),
      beside(
          make_beside(wanted, must, live, grid.grid, traversal->branch_nodes(), grid.create_exact)),
      force((traversal->walk_beside(beside.get()), grid.grid), traversal->branch_nodes(),
            grid.fields, std::move(records_)) {}

}  // namespace hapgrid
