#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"
#include "tests/unit/molecule/reference.hpp"

using namespace molecules;

TEST_CASE("force, energy, shape and equal do not allocate") {
  const auto model = kEnkephalin.make();
  HybridEnergy energy(kEnkephalin.read(), {});
  Random random(20);
  std::vector<std::vector<double>> states;
  states.reserve(100);
  for (int i = 0; i < 100; ++i) states.push_back(random.state(energy));
  std::vector<float> centres(3 * model->info().spheres.size());
  double total = 0;
  const std::uint64_t before = hapgrid::testing::allocations();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double* s = states[i].data();
    const hapgrid::Vec3 x{random.between(-5, 5), random.between(-3, 3), random.between(-3, 3)};
    total += model->force(x, s)[0] + model->energy(x, s);
    model->shape(x, s, centres);
    total += centres[0] + model->equal(s, states[(i + 1) % states.size()].data());
  }
  CHECK(hapgrid::testing::allocations() == before);
  CHECK(std::isfinite(total));
}
