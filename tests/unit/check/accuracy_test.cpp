#include "libcore/check/accuracy.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "libcore/base/error.hpp"
#include "libcore/follow/paper_traversal.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/check/tiny_grid.hpp"
#include "tests/unit/follow/random_grid.hpp"

using namespace hapgrid;
using tiny::figure;

namespace {

/// A model whose state is s(x) wherever it comes from, and a grid of it; the stored force is twice
/// the state, along x.
using Field = double (*)(const Vec3&);

tiny::TestModel::Convert model_of(Field field) {
  return [field](const double*, const Vec3& x, const Vec3& d, double* row, std::string&) {
    row[0] = field({x[0] + d[0], x[1] + d[1], x[2] + d[2]});
    row[1] = 2 * row[0];
    row[2] = row[3] = 0;
    return true;
  };
}

Grid grid_of(Field field, const Box& box) {
  GridSpec spec;
  spec.box = box;
  spec.tolerance = 1e-9;
  spec.equality.norm = Equality::Norm::kMax;
  spec.stored.force = true;
  RecordColumns columns = testing::random_columns(box, 4, 1, 1);
  for (PointIndex p = 0; p < box.points(); ++p) {
    const double s = field(box.position(p));
    std::ranges::copy(std::array{s, 2 * s, 0., 0.}, &columns.rows[4 * p]);
  }
  return Grid(spec, 1, columns);
}

Walked walk(const Grid& grid, const tiny::TestModel::Convert& model, std::uint64_t walks,
            int threads = 2, std::uint64_t seed = 1) {
  std::atomic<std::uint64_t> done{0};
  Walked walked = walk_grid(
      grid, walks, seed, [&] { return std::make_unique<tiny::TestModel>(grid.spec(), model); },
      [&] { return std::make_unique<PaperTraversal>(grid); }, threads, done);
  CHECK(done == walks);
  CHECK(walked.places == walked.one_branch.size() + walked.empty + walked.mixed + walked.parted);
  return walked;
}

Check row(const Grid& grid, const Walked& walked, std::optional<double> wanted = std::nullopt) {
  return check_accurate(grid.spec(), walked, grid.spec().stored.force, wanted);
}

double square(const Vec3& x) { return x[0] * x[0]; }
double linear(const Vec3& x) { return 1 + x[0] - 3 * x[1] + 0.5 * x[2]; }
double products(const Vec3& x) { return x[0] * x[1] * x[2] + x[0] * x[1] - x[2]; }
double kink(const Vec3& x) { return std::abs(x[0] - 0.3); }

}  // namespace

TEST_CASE("of x² interpolation is off by h² t (1 - t), with twice the spacing by four times it") {
  const double h = 0.25;
  const Grid grid = grid_of(square, {{-3, 0, 0}, h, {33, 1, 1}});
  const Walked walked = walk(grid, model_of(square), 400);
  CHECK(walked.places == 400 * kPlacesInWalk);
  CHECK(walked.one_branch.size() == walked.places);
  for (const PlayError& e : walked.one_branch) {
    CHECK(e.state <= h * h / 4 + 1e-12);
    CHECK(e.coarse_state <= h * h + 1e-12);
    // The stored force is interpolated, too.
    CHECK(e.force == Approx(2 * e.state).margin(1e-12));
    // t in the large cell is t/2 or 1/2 + t/2: 4 τ (1 - τ) = t (2 - t) or 1 - t², either of which
    // is 1 - t' ² with t' = t or 1 - t, while the small one's error is t' (1 - t').
    const double other = std::sqrt(std::max(0.0, 1 - e.coarse_state / (h * h)));
    CHECK(e.state == Approx(h * h * other * (1 - other)).margin(1e-8));
  }
  // Uniform t: the median of t (1 - t) is 3/16, 99 % are below 1/4 - 0.005²; some 12,800 places
  // leave 1 % of the median.
  const Check check = row(grid, walked);
  CHECK(check.is_note);
  CHECK(figure(check, "state median") == Approx(3. / 16 * h * h).epsilon(0.03));
  CHECK(figure(check, "state 99 %") == Approx(h * h / 4).epsilon(0.001));
  CHECK(figure(check, "force 99 %") == Approx(h * h / 2).epsilon(0.001));
  CHECK(figure(check, "state worst") <= h * h / 4 + 1e-12);
  CHECK(figure(check, "order") == Approx(2).margin(0.01));
  CHECK(figure(check, "one branch") == 1);
}

TEST_CASE("the fault is more than one place in a hundred") {
  const Grid grid = grid_of(square, {{0, 0, 0}, 1, {4, 1, 1}});
  Walked walked;
  walked.places = 200;
  for (int i = 0; i < 200; ++i) walked.one_branch.push_back({i < 198 ? 0.1 : 1.0, 0, 0.4});
  CHECK(row(grid, walked, 0.1).verdict() == "ok");
  CHECK(row(grid, walked, 0.1).found.offenders == 0);
  walked.one_branch[0].state = 0.5;
  CHECK(row(grid, walked, 0.1).verdict() == "broken");
  CHECK(row(grid, walked, 0.1).found.offenders == 3);
  CHECK(row(grid, walked, 0.5).verdict() == "ok");
  CHECK(row(grid, walked).verdict() == "note");
}

TEST_CASE("what multilinear interpolation has exactly is exact") {
  const Box box{{-1, 0.5, 2}, 0.125, {5, 6, 7}};
  for (const Field field : {linear, products})
    CHECK(walk(grid_of(field, box), model_of(field), 20).state.value < 1e-13);
  // Along an axis with two points there is no coarser grid; along one with a single point no
  // motion.
  const Walked flat = walk(grid_of(linear, {{0, 0, 0}, 1, {2, 1, 4}}), model_of(linear), 5);
  CHECK(flat.places == 5 * kPlacesInWalk);
  for (const PlayError& e : flat.one_branch) CHECK(std::isnan(e.coarse_state));
  CHECK(walk(grid_of(linear, {{0, 0, 0}, 1, {1, 1, 1}}), model_of(linear), 5).places == 0);
}

TEST_CASE("a kink is off where it is, by at most the half of its turn and h/2") {
  const double h = 0.5;
  const Walked walked = walk(grid_of(kink, {{-2, 0, 0}, h, {9, 1, 1}}), model_of(kink), 100);
  CHECK(walked.state.value <= 2 * h / 4);
  CHECK(walked.state.value > 0.9 * 2 * 0.3 * 0.2 / 0.5);  // of the kink 0.3 into its cell
  std::size_t off = 0;
  for (const PlayError& e : walked.one_branch) off += e.state > 1e-12;
  // One cell of eight.
  CHECK(static_cast<double>(off) / static_cast<double>(walked.places) ==
        Approx(0.125).epsilon(0.4));
}

TEST_CASE("places without change are counted apart, and walks begin where there is one") {
  const Field bump = [](const Vec3& x) { return std::max(0.0, 1 - x[0] * x[0]); };
  const Grid grid = grid_of(bump, {{-32, 0, 0}, 0.5, {129, 1, 1}});
  const Walked walked = walk(grid, model_of(bump), 200);
  CHECK(walked.empty > 0);
  // 4 of 128 cells are the bump's; all errors belong there.
  CHECK(walked.one_branch.size() > walked.places / 10);
  // What the grid steps over is not empty: the corners are, the model is not.
  const Field narrow = [](const Vec3& x) { return std::abs(x[0] - 0.25) < 0.2 ? 1.0 : 0.0; };
  const Walked missed = walk(grid_of(narrow, {{0, 0, 0}, 0.5, {2, 1, 1}}), model_of(narrow), 20);
  CHECK(missed.state.value == 1);
}

// A body on a string: at 1 until the string breaks at 2.4, at 0 from there on, also on the way
// back, until it is caught again at 0.6. Five points, two levels at 1 and 2.
TEST_CASE("behind the end of a branch places are mixed and parted, and not judged") {
  GridSpec spec;
  spec.box = {{0, 0, 0}, 1, {5, 1, 1}};
  spec.tolerance = 1e-9;
  RecordColumns c;
  tiny::add(c, 0, 0, 0, 1, kLeavesBox, 0);
  tiny::add(c, 1, 0, 0, 1, 0, 0);
  tiny::add(c, 1, 1, 0, 0, 0, 1);
  tiny::add(c, 2, 0, 0, 1, 0, 0);
  tiny::add(c, 2, 1, 0, 0, 1, 0);
  tiny::add(c, 3, 0, 0, 0, 1, 0);
  tiny::add(c, 4, 0, 0, 0, 0, kLeavesBox);
  const Grid grid(spec, 1, c);
  const auto string = [](const double* s, const Vec3& x, const Vec3& d, double* row, std::string&) {
    const double to = x[0] + d[0];
    *row = to > 2.4 ? 0 : to < 0.6 ? 1 : *s;
    return true;
  };
  const Walked walked = walk(grid, string, 100);
  CHECK(walked.mixed > 0);
  CHECK(walked.parted > 0);
  CHECK(walked.empty > 0);
  CHECK(walked.mixed_state.value > 0.5);
  // The string that is caught again on the way back is no branch that ends: it can be taken back.
  CHECK(walked.state.value <= 1);
  for (const PlayError& e : walked.one_branch) CHECK(std::isnan(e.coarse_state));
}

TEST_CASE("conversions that fail are listed, and the walk goes on elsewhere") {
  const Grid grid = grid_of(square, {{-3, 0, 0}, 0.25, {33, 1, 1}});
  const auto model = [convert = model_of(square)](const double* s, const Vec3& x, const Vec3& d,
                                                  double* row, std::string& error) {
    error = "too far";
    return x[0] + d[0] < 2 && convert(s, x, d, row, error);
  };
  const Walked walked = walk(grid, model, 30);
  CHECK(walked.failed.offenders > 0);
  CHECK(walked.places > 0);
  const Check check = row(grid, walked);
  CHECK(check.verdict() == "note");
  CHECK(check.found.offenders == walked.failed.offenders);
  CHECK(check.found.first[0].text.starts_with("conversion to ("));
  CHECK(check.found.first[0].text.find("failed: too far") != std::string::npos);
  CHECK(row(grid, walked, 100.0).verdict() == "broken");
}
