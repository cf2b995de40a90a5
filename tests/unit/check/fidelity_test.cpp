#include "libcore/check/fidelity.hpp"

#include "tests/unit/catch.hpp"
#include "tests/unit/check/tiny_grid.hpp"
#include "tests/unit/follow/random_grid.hpp"

using namespace hapgrid;

TEST_CASE("a conversion that fails is an offender in the model's words") {
  const Grid grid = tiny::grid();
  std::atomic<std::uint64_t> done{0};
  const auto check = check_fidelity(
      grid, std::vector<RecordIndex>{3},
      [] {
        return std::make_unique<tiny::TestModel>(
            tiny::spec(),
            [](const double*, const Vec3& x, const Vec3&, double*, std::string& error) {
              error = "no minimum near " + std::to_string(x[0]);
              return false;
            });
      },
      1, done);
  CHECK(check.found.counted == 2);
  CHECK(check.found.offenders == 2);
  CHECK(check.found.first.front().text ==
        "point 2 (2, 0, 0) level 0 direction 12 (-1, 0, 0): conversion failed: no minimum near "
        "1.000000");
}

TEST_CASE("the sample is the same on every platform") {
  // From an implementation of SplitMix64 and Floyd's algorithm in Python that shares nothing with
  // ours; its generator gives 6457827717110365317 first for the seed 1234567, as published.
  const Grid grid = testing::random_grid({{0, 0, 0}, 1, {200, 1, 1}}, 1, 1, 1);
  CHECK(sample_records(grid, 8, 1) ==
        std::vector<RecordIndex>{1, 105, 122, 132, 133, 141, 148, 175});
  CHECK(sample_records(grid, 8, 2) == std::vector<RecordIndex>{6, 15, 64, 101, 108, 117, 135, 155});
  CHECK(sample_records(grid, 0, 1).empty());
  CHECK(sample_records(grid, 200, 1).size() == 200);
  CHECK(sample_records(grid, 201, 1).size() == 200);
}

TEST_CASE("the frontier is not sampled") {
  CHECK(sample_records(tiny::after_one_round(), 1000, 1) == std::vector<RecordIndex>{0, 3});
}
