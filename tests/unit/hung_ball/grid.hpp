// Grids of the hung ball, by the search itself.
#pragma once

#include "tests/unit/catch.hpp"
#include "tests/unit/hung_ball/reference.hpp"
#include "tests/unit/search/shards.hpp"

namespace hung_ball {

inline hapgrid::Grid grid(const hapgrid::Box& box) {
  using namespace hapgrid;
  Definition definition;
  definition.model = "hung-ball";
  definition.box = box;
  const TemporaryDirectory dir;
  const Plugin plugin("hung-ball", {HAPGRID_BUILD_DIR "/models"});
  const auto model = plugin.create({});
  const GridSpec spec = spec_of(definition, *model);
  write_shard(dir.file("seeds"), {Content::kGrid, 0, spec},
              [&](SectionWriter& out) { write_seeds(definition, spec, *model, out); });
  complete_shard(dir.file("seeds"), dir.file("grid"), 1, plugin);
  return load_grid(dir.file("grid"));
}

}  // namespace hung_ball
