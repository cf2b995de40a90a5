// A grid that is packed for a page and unpacked there is the same, but for what is not seen.
#include "tools/page/pack.hpp"

#include "libcore/base/error.hpp"
#include "libcore/grid/grid.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/follow/random_grid.hpp"
#include "tools/page/packed_grid.hpp"

using namespace hapgrid;

namespace {

const MakeModel kNoModel = []() -> std::unique_ptr<Model> {
  throw ModelError("asked for a model");
};

/// Two branches in a box, on one of which the energy is x^2 / 2; three spheres, of which the second
/// does not move. @param exact the force is the gradient of that energy
Grid two_branches(const GridCoordinates& counts, bool exact) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<float> anywhere(-3, 3);
  GridSpec spec;
  spec.box = {{-0.4, 0.1, -0.2}, 0.2, counts};
  spec.state_size = 2;
  spec.force_scale = 2;
  spec.stored = {.force = true, .energy = true, .shape = true};
  spec.spheres.resize(3);
  for (int k = 0; k < 3; ++k) spec.spheres[k].radius = 0.1F + static_cast<float>(k);
  RecordColumns columns;
  const auto levels = [&](PointIndex p) -> Level { return spec.box.coordinates(p)[0] < 3 ? 1 : 2; };
  const Neighbourhood around(spec.box);
  for (PointIndex p = 0; p < spec.box.points(); ++p)
    for (Level level = 0; level < levels(p); ++level) {
      const Vec3 x = spec.box.position(p);
      const double force = -2 * x[0] * (exact ? 1 : -1), energy = 5 + level + x[0] * x[0] / 2;
      std::vector<double> row{1.0 * level, x[1], force, 0, 0, energy};
      for (int c = 0; c < 9; ++c) row.push_back(c / 3 == 1 ? 0.25F : anywhere(random));
      testing::add_record(columns, around, p, level, row,
                          [&](PointIndex to) { return levels(to) <= level ? Level{0} : level; });
    }
  return Grid(spec, 1, columns);
}

UnpackedGrid unpacked(const PackedGrid& packed) {
  return unpack_grid(reinterpret_cast<const unsigned char*>(packed.bytes.data()));
}

}  // namespace

TEST_CASE("levels, links, forces and energies come back, and places to a part of a pixel") {
  const bool exact = GENERATE(true, false);
  const GridCoordinates counts = GENERATE(GridCoordinates{7, 5, 6}, GridCoordinates{7, 1, 4});
  const Grid grid = two_branches(counts, exact);
  const PackedGrid packed = pack_grid(grid, "grid", kNoModel, {0, -1, 0});
  const UnpackedGrid got = unpacked(packed);
  CHECK(got.by_energy == exact);
  REQUIRE(got.grid.records() == grid.records());
  CHECK(got.grid.state_size() == 0);
  CHECK(got.moved == std::vector<std::uint32_t>{0, 1, 2, 6, 7, 8});
  CHECK(got.centres[4] == 0.25F);
  CHECK(got.scene.spheres[2].radius == grid.spec().spheres[2].radius);
  CHECK(got.scene.box == grid.box());
  double lowest = grid.row(0)[5];
  for (RecordIndex r = 0; r < grid.records(); ++r) lowest = std::min(lowest, grid.row(r)[5]);
  double farthest = 0;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    const auto row = grid.row(r), its = got.grid.row(r);
    REQUIRE(got.grid.point(r) == grid.point(r));
    REQUIRE(std::ranges::equal(got.grid.links(r), grid.links(r)));
    REQUIRE(got.fields.force[r][0] == static_cast<float>(row[2]));
    const double energy = exact ? 2 * (row[5] - lowest) : 0;
    REQUIRE(got.fields.energy[r] == Approx(energy).margin(1e-6));
    for (std::size_t i = 0; i < got.moved.size(); ++i)
      farthest = std::max(farthest, std::abs(its[i] - row[6 + got.moved[i]]));
  }
  CHECK(farthest > 0);
  CHECK(farthest <= 0.2 / 200 / 2 + 1e-9);
}

TEST_CASE("the hand begins where no force acts, to the left, and else in the middle") {
  // Force only where x = 0 has none: that is the plane of the third points.
  const Grid grid = two_branches({7, 5, 6}, true);
  const PackedGrid packed = pack_grid(grid, "grid", kNoModel, {0, -1, 0});
  CHECK(std::abs(packed.first.position[0]) < 1e-12);
  CHECK(packed.first.position[1] == Approx(0.5));
  CHECK(packed.first.centres.size() == 9);
}

TEST_CASE("what is too large is refused with the spacing that would fit") {
  GridSpec spec;
  spec.box = {{0, 0, 0}, 0.1, {10, 20, 30}};
  spec.length_unit = "angstrom";
  CHECK(spacing_for(spec, 1.0 / 8) == "0.21 angstrom");
  spec.box.counts[1] = 1;
  CHECK(spacing_for(spec, 1.0 / 4) == "0.21 angstrom");
}
