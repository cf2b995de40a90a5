// What checks forgive where numbers may be off, and what they do not: on the tiny grid.
#include "libcore/check/precision.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "libcore/base/error.hpp"
#include "tests/unit/check/tiny_grid.hpp"

using namespace hapgrid;

namespace {

/// The tiny grid with one state moved; its range is 2.
LoadedGrid loaded(double precision, RecordIndex moved = 0, double by = 0) {
  RecordColumns columns = tiny::records();
  columns.rows[moved] += by;
  Coding coding{true, precision, {}};
  if (precision > 0) coding.bounds = {2 * precision};
  return {Grid(tiny::spec(), tiny::kGeneration, columns), coding, 100};
}

bool near(const double* a, const double* b) { return std::abs(*a - *b) <= 1e-6; }

}  // namespace

TEST_CASE("precision: numbers are within the bounds of the original, or bit by bit") {
  const LoadedGrid original = loaded(0);
  CHECK(check_precision(loaded(0), original).found.offenders == 0);
  CHECK(check_precision(loaded(0), original).found.counted == 6);
  CHECK(check_precision(loaded(0, 3, 1e-15), original).found.offenders == 1);
  CHECK(check_precision(loaded(0.01, 3, 0.0199), original).found.offenders == 0);
  const Check beyond = check_precision(loaded(0.01, 3, 0.0201), original);
  CHECK(beyond.found.offenders == 1);
  CHECK(beyond.found.first.at(0).find("point 2 (2, 0, 0) level 0: component 0 is -0.9799") == 0);
  CHECK_THROWS_AS(check_precision(original, loaded(0.01)), Error);

  RecordColumns columns = tiny::records();
  tiny::link(columns, 1, tiny::kRight) = 0;
  const LoadedGrid linked{Grid(tiny::spec(), tiny::kGeneration, columns), {}, 100};
  CHECK(check_precision(linked, original).found.offenders == 1);
}

TEST_CASE("precision: a bound is no more than what was recorded allows") {
  CHECK(check_precision(loaded(0.01)).found.offenders == 0);
  CHECK(check_precision(loaded(0.01)).found.counted == 1);
  // The range of the original may have been larger by two bounds.
  LoadedGrid generous = loaded(0.01);
  generous.coding.bounds = {0.0204};
  CHECK(check_precision(generous).found.offenders == 0);
  generous.coding.bounds = {0.0205};
  CHECK(check_precision(generous).found.offenders == 1);
}

TEST_CASE("states are distinct unless they are the same wherever the bounds put them") {
  const double a = 1, b = 1.03;
  CHECK_FALSE(same_in_spite_of(near, loaded(0))(&a, &b));
  CHECK(same_in_spite_of(near, loaded(0))(&a, &a));
  CHECK_FALSE(same_in_spite_of(near, loaded(0.01))(&a, &a));
  // A tolerance that is wider than what the bounds can do.
  const SameState wide = [](const double* x, const double* y) { return std::abs(*x - *y) <= 2; };
  CHECK(same_in_spite_of(wide, loaded(0.01))(&a, &b));
}

TEST_CASE("fidelity forgives what the bounds explain") {
  // Keeps the side that a state is on.
  ModelFunctions model;
  int conversions = 0;
  model.convert = [&](const double* s, const Vec3&, const Vec3&, double* row, std::string&) {
    ++conversions;
    *row = *s < 0 ? -1 : 1;
    return true;
  };
  model.same = near;
  const LoadedGrid lossy = loaded(0.01);  // the bound is 0.02
  const auto holds = [&](double start, double stored) {
    const ModelFunctions functions = forgiving(model, lossy);
    double row = 0;
    std::string error;
    conversions = 0;
    REQUIRE(functions.convert(&start, {}, {}, &row, error));
    return functions.same(&row, &stored);
  };
  CHECK(holds(0.5, 1));
  CHECK(conversions == 1);
  CHECK(holds(0.5, 1.0399));
  CHECK_FALSE(holds(0.5, 1.0401));
  CHECK_FALSE(holds(0.5, -1));
  // Next to the tear-off the bound decides on the side.
  CHECK(holds(0.019, -1));
  CHECK_FALSE(holds(0.021, -1));
  CHECK(holds(-0.019, 1));
  // Where nothing was lost nothing is forgiven.
  CHECK_FALSE(forgiving(model, loaded(0)).same(&lossy.coding.bounds[0], &lossy.coding.precision));
}
