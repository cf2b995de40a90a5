// Where a molecule ends that was pushed at random, when its grid has several minima (`hapgrid
// molecule --basins`): by the grid, and by the model itself.
//
//   bench_basins GRID MODELS [PUSHES] [SEED]
//
// MODELS is the directory of the plug-ins. Each push (150) begins with the first of the states that
// the model knows in a corner of the box. The HIP comes from the side of the box in a random
// direction, aims near a random sphere of that state, stops up to 1 before and 2 behind it (in the
// model's unit), and leaves on the same line.
//
// A line for each pair of ends: known state by the grid, by the model ("-": none), pushes. Then a
// sum. The exit code is 1 when a push ends in no known state by the grid, or fewer than 29 of 30
// where the model does.
#include <cstdlib>
#include <map>
#include <memory>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/model_traversal.hpp"
#include "tests/bench/bench.hpp"

namespace {

using namespace hapgrid;
using namespace hapgrid::bench;

constexpr double kTick = 0.02;  // of the model's unit
constexpr int kNone = -1;

class Pushes {
 public:
  Pushes(const Grid& grid, Model& model, std::uint64_t seed) : random_(seed) {
    const Box& box = grid.box();
    low_ = box.origin;
    for (int a = 0; a < 3; ++a) high_[a] = low_[a] + box.spacing * (box.counts[a] - 1);
    known_ = model.known_states(low_);
    if (known_.size() < 2 * model.state_size()) throw Error("the model knows one state at rest");
    centres_.resize(3 * model.info().spheres.size());
    model.shape(low_, known_.data(), centres_);
  }

  std::vector<Vec3> next() {
    Vec3 u{}, aim{};
    double length = 0;
    while (!(length > 0.1 && length < 1)) {
      for (double& v : u) v = uniform(random_, -1, 1);
      length = std::hypot(u[0], u[1], u[2]);
    }
    const std::size_t sphere = random_() % (centres_.size() / 3);
    double before = 1e30, behind = 1e30;  // how far the box goes
    for (int a = 0; a < 3; ++a) {
      u[a] /= length;
      aim[a] = centres_[3 * sphere + a] + uniform(random_, -0.8, 0.8);
      before = std::min(before, ((u[a] > 0 ? low_[a] : high_[a]) - aim[a]) / -u[a]);
      behind = std::min(behind, ((u[a] > 0 ? high_[a] : low_[a]) - aim[a]) / u[a]);
    }
    before *= 0.98;
    const double way = before + std::min(uniform(random_, -1, 2), 0.98 * behind);
    const int ticks = static_cast<int>(std::ceil(way / kTick));
    std::vector<Vec3> path;
    for (int i = 0; i <= 2 * ticks; ++i) {
      const double at = way * (i <= ticks ? i : 2 * ticks - i) / ticks - before;
      path.push_back({aim[0] + at * u[0], aim[1] + at * u[1], aim[2] + at * u[2]});
    }
    return path;
  }

  /// The known state that a state is.
  int end(Model& model, std::span<const double> state) const {
    const std::size_t n = model.state_size();
    for (std::size_t k = 0; k < known_.size() / n; ++k)
      if (model.equal(state.data(), &known_[k * n])) return static_cast<int>(k);
    return kNone;
  }

 private:
  std::mt19937_64 random_;
  Vec3 low_, high_;
  std::vector<double> known_;
  std::vector<float> centres_;
};

void follow(Traversal& traversal, const std::vector<Vec3>& path) {
  for (std::size_t i = 0; i < path.size(); ++i)
    if (!go(traversal, path, i).usable()) throw Error("a push cannot be followed to its end");
}

int run(const Grid& grid, int argc, char** argv) {
  const MakeModel make = model_of(grid, argv[2]);
  const int count = argc > 3 ? std::atoi(argv[3]) : 150;
  const std::unique_ptr<Model> model = make();
  Pushes pushes(grid, *model, argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1);
  ModelTraversal truth(grid, make());
  BranchTraversal play(grid, std::make_shared<const BranchNodes>(grid));
  std::map<std::pair<int, int>, int> ends;
  int nowhere = 0, same = 0, leave = 0;
  for (int i = 0; i < count; ++i) {
    const std::vector<Vec3> path = pushes.next();
    follow(truth, path);
    follow(play, path);
    const int a = pushes.end(*model, play.state()), b = pushes.end(*model, truth.state());
    ++ends[{a, b}];
    nowhere += a == kNone;
    same += a == b && a != kNone;
    leave += b != 0;
  }
  for (const auto& [end, n] : ends) {
    const auto name = [](int k) { return k == kNone ? std::string("-") : std::to_string(k); };
    std::printf("grid %s\tmodel %s\t%d pushes\n", name(end.first).c_str(), name(end.second).c_str(),
                n);
  }
  std::printf("%d pushes: %d end in no known state, %d where the model does; %d leave state 0\n",
              count, nowhere, same, leave);
  return nowhere > 0 || 30 * same < 29 * count ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::main_of(argc, argv, 3, "bench_basins GRID MODELS [PUSHES] [SEED]", run);
}
