// How many conversions of a molecule's grid end in another state when the HIP's substep is halved:
//
//   build/bench/bench_substeps table2/leu-enkephalin.grid 1500
//
// takes 1500 of the grid's records and evaluates C in all directions with the grid's own substep
// and with half of it. It prints the conversions whose results the tolerance function tells apart,
// and their share.
#include <cstdio>
#include <cstdlib>

#include "libcore/check/fidelity.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/model/plugin_model.hpp"
#include "libcore/shard/load.hpp"

using namespace hapgrid;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: bench_substeps GRID RECORDS\n");
    return 2;
  }
  const LoadedGrid loaded = load_grid(argv[1]);
  const Grid& grid = loaded.grid;
  const Plugin plugin(grid.spec().model, {HAPGRID_BUILD_DIR "/models"});
  std::vector<Parameter> halved = grid.spec().parameters;
  double substep = 0;
  for (Parameter& p : halved)
    if (p.key == "substep") {
      substep = std::get<double>(p.value);
      p.value = substep / 2;
    }
  const auto model = plugin.create(grid.spec().parameters), finer = plugin.create(halved);

  long conversions = 0, moved = 0, other = 0;
  std::vector<double> a(grid.state_size()), b(grid.state_size());
  for (const RecordIndex r : sample_records(grid, std::strtoull(argv[2], nullptr, 10), 1)) {
    const Vec3 x = grid.box().position(grid.point(r));
    const double* state = grid.state(r).data();
    for (int q = 0; q < kDirections; ++q) {
      if (!(grid.neighbourhood().inside(grid.point(r)) >> q & 1)) continue;
      const Vec3& d = grid.neighbourhood().shift(q);
      if (!model->convert(state, x, d, a.data()) || !finer->convert(state, x, d, b.data())) {
        std::fprintf(stderr, "%s: %s %s\n", describe_link(grid, r, q).c_str(),
                     model->error().c_str(), finer->error().c_str());
        return 1;
      }
      ++conversions;
      for (const double c : a)
        if (c != 0) {
          ++moved;
          break;
        }
      if (model->equal(a.data(), b.data())) continue;
      ++other;
      std::printf("%s: %s, finer %s\n", describe_link(grid, r, q).c_str(), state_text(a).c_str(),
                  state_text(b).c_str());
    }
  }
  std::printf(
      "substep %g Å: %ld of %ld conversions (%.3f %%) end elsewhere with half of it; %ld of all "
      "end with the molecule moved\n",
      substep, other, conversions,
      100.0 * static_cast<double>(other) / static_cast<double>(conversions), moved);
}
