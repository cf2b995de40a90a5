// The plug-in around the soft tissue's finite elements.

#include "libcore/model/plugin_model.hpp"
#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

const std::vector<Parameter> kSmall{{"size", std::vector<double>{24, 24, 12}},
                                    {"elements", std::vector<double>{4, 4, 2}},
                                    {"probe_radius", 8.0}};

std::unique_ptr<Model> make(std::vector<Parameter> parameters,
                            const std::vector<Parameter>& more = {}) {
  parameters.insert(parameters.end(), more.begin(), more.end());
  return Plugin("soft-tissue", {HAPGRID_BUILD_DIR "/models"}).create(parameters);
}

}  // namespace

TEST_CASE("rest is known where the ball touches nothing") {
  const auto model = make(kSmall);
  CHECK(model->known_states({0, 0, 24}) == std::vector<double>(150, 0.0));
  CHECK(model->known_states({0, 0, 19}).empty());
}

TEST_CASE("a state, and what a grid stores with it") {
  const auto model = make(kSmall);
  REQUIRE(model->state_size() == 150);
  const std::size_t spheres = model->info().spheres.size();
  REQUIRE(spheres == 25 + 16);
  REQUIRE(model->row_size() == 150 + 3 + 1 + 3 * spheres);
  const std::vector<double> rest(150, 0.0);
  std::vector<double> touched(model->row_size()), pushed(model->row_size());
  REQUIRE(model->convert(rest.data(), {0, 0, 24}, {0, 0, -4}, touched.data()));
  REQUIRE(model->convert(touched.data(), {0, 0, 20}, {0, 0, -2}, pushed.data()));
  const Vec3 f = model->force({0, 0, 18}, pushed.data());
  CHECK(f == Vec3{pushed[150], pushed[151], pushed[152]});
  CHECK(model->energy({0, 0, 18}, pushed.data()) == pushed[153]);
  CHECK(std::abs(f[2]) > 0.01);
  CHECK(std::abs(f[0]) < 1e-6);
  std::vector<float> centres(3 * spheres);
  model->shape({0, 0, 18}, pushed.data(), centres);
  // Balls that touch the surface from inside, as high as the block.
  const double radius = model->info().spheres[0].radius;
  CHECK(radius == 6);
  double lowest = 12;
  for (std::size_t i = 0; i < centres.size(); ++i) CHECK(centres[i] == pushed[154 + i]);
  // The top's middle node has gone down.
  for (std::size_t i = 0; i < centres.size(); i += 3)
    if (std::hypot(centres[i], centres[i + 1]) < 1)
      lowest = std::min(lowest, centres[i + 2] + radius);
  CHECK(lowest < 11);
  CHECK(lowest > 8);
}

TEST_CASE("states are equal when no node is farther apart than the tolerance") {
  const auto model = make(kSmall, {{"tolerance", 0.5}});
  std::vector<double> a(150, 0.0), b(150, 0.0);
  b[147] = 0.3;
  b[149] = 0.4;
  CHECK(model->equal(a.data(), b.data()));
  b[148] = 0.01;
  CHECK_FALSE(model->equal(a.data(), b.data()));
  CHECK_FALSE(model->equal(b.data(), a.data()));
  b[148] = std::nan("");
  CHECK_FALSE(model->equal(b.data(), b.data()));
}
