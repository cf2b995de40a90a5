// What a step of play costs in CPU time, against vtkImageInterpolator, which many programs take for
// a field on a grid: the same path, the same numbers at the same points, both in one run and in
// turns.
//
//   bench_interpolation [TURNS]
//
// The machine drifts, so the least of the turns counts. The path is sampled so that the HIP spends
// a given number of ticks in a cell. At 1 kHz, with a workspace of 150 mm as the box and a hand at
// 0.1 m/s, that is 50 ticks a cell with 30 points a side and 12 with 128. VTK gets an image with
// the numbers of level 0, and interpolates them linearly at a place, no more. Play follows the hand
// from cell to cell, by links: on a grid of one branch by the rule `branch`, and on a grid of which
// half the points have two levels, with random links, by the rule `paper`.
#include <time.h>
#include <vtkImageData.h>
#include <vtkImageInterpolator.h>
#include <vtkNew.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/paper_traversal.hpp"
#include "tests/unit/follow/random_grid.hpp"

namespace {

using namespace hapgrid;

constexpr std::uint32_t kStateSize = 9;
constexpr std::size_t kSteps = 1 << 20;

double cpu_ns() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e9 + static_cast<double>(t.tv_nsec);
}

vtkNew<vtkImageData> image_of(const Grid& grid) {
  const Box& box = grid.box();
  vtkNew<vtkImageData> image;
  image->SetOrigin(box.origin.data());
  image->SetSpacing(box.spacing, box.spacing, box.spacing);
  image->SetDimensions(static_cast<int>(box.counts[0]), static_cast<int>(box.counts[1]),
                       static_cast<int>(box.counts[2]));
  image->AllocateScalars(VTK_DOUBLE, kStateSize);
  auto* out = static_cast<double*>(image->GetScalarPointer());
  for (PointIndex p = 0; p < box.points(); ++p, out += kStateSize)
    std::copy_n(grid.state(grid.first(p)).data(), kStateSize, out);
  return image;
}

/// Nanoseconds a step.
double time(const std::vector<Vec3>& path,
            const std::function<double(const std::vector<Vec3>&)>& go) {
  const double begin = cpu_ns();
  const double sum = go(path);
  const double passed = cpu_ns() - begin;
  if (!(sum > -1e300)) std::abort();
  return passed / static_cast<double>(path.size());
}

std::function<double(const std::vector<Vec3>&)> follower(Traversal& traversal) {
  return [&traversal](const std::vector<Vec3>& path) {
    double sum = 0;
    traversal.start(path[0]);
    for (const Vec3& x : path) {
      traversal.step(x);
      sum += traversal.state()[0];
    }
    return sum;
  };
}

/// A Lissajous figure that stays inside [-1, 1]^3, with steps of about the length `step`.
std::vector<Vec3> smooth_path(double step, std::size_t count) {
  std::vector<Vec3> path(count);
  double t = 0;
  for (Vec3& x : path) {
    x = {0.97 * std::sin(t), 0.97 * std::sin(1.618 * t + 0.5), 0.97 * std::sin(2.414 * t + 1)};
    const double speed = std::hypot(0.97 * std::cos(t), 1.57 * std::cos(1.618 * t + 0.5),
                                    2.34 * std::cos(2.414 * t + 1));
    t += step / std::max(speed, 0.3);
  }
  return path;
}

void compare(std::uint32_t side, int ticks_a_cell, int turns) {
  const double spacing = 2.0 / (side - 1);
  const Box box{{-1, -1, -1}, spacing, {side, side, side}};
  const Grid two = testing::random_grid(box, kStateSize, 2, 1);
  const Grid one = testing::random_grid(box, kStateSize, 1, 1);
  const auto path = smooth_path(spacing / ticks_a_cell, kSteps);
  const vtkNew<vtkImageData> image = image_of(two);
  vtkNew<vtkImageInterpolator> interpolator;
  interpolator->SetInterpolationModeToLinear();
  interpolator->Initialize(image);
  interpolator->Update();
  BranchTraversal branch(one, std::make_shared<const BranchNodes>(one));
  PaperTraversal paper(two);
  const std::function<double(const std::vector<Vec3>&)> ways[] = {
      [&](const std::vector<Vec3>& places) {
        double sum = 0, value[kStateSize];
        for (const Vec3& x : places) {
          interpolator->Interpolate(x.data(), value);
          sum += value[0];
        }
        return sum;
      },
      follower(branch), follower(paper)};
  double least[3] = {1e300, 1e300, 1e300};
  for (int turn = 0; turn < turns; ++turn)
    for (int w = 0; w < 3; ++w) least[w] = std::min(least[w], time(path, ways[w]));
  std::printf("%u\t%d\t%.1f\t%.1f\t%.1f\n", side, ticks_a_cell, least[0], least[1], least[2]);
}

}  // namespace

int main(int argc, char** argv) {
  const int turns = argc > 1 ? std::atoi(argv[1]) : 7;
  std::printf("# points a side, ticks a cell; ns a step: vtkImageInterpolator, branch, paper\n");
  compare(30, 50, turns);
  compare(30, 12, turns);
  compare(128, 50, turns);
  compare(128, 12, turns);
  return 0;
}
