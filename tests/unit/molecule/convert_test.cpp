// The conversion function as the filters call it, through the plug-in.

#include "libcore/scene/drawing.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/molecule/reference.hpp"
#include "tools/apps/molecule/conversion.hpp"

using namespace molecules;
using namespace hapgrid;

namespace {

/// A walk of the HIP through and about the molecule: f(s, x, d, reached).
template <class F>
void walk(Model& model, double reach, unsigned seed, int steps, double length, F&& f) {
  Random random(seed);
  Vec3 x{reach, reach, reach};
  Eigen::Vector3d heading(-1, -1, -1);
  State s(model.state_size());
  for (int i = 0; i < steps; ++i) {
    for (int a = 0; a < 3; ++a) heading[a] += random.between(-0.5, 0.5);
    heading.normalize();
    Vec3 d{};
    for (int a = 0; a < 3; ++a) {
      if (std::abs(x[a] + length * heading[a]) > reach) heading[a] = -heading[a];
      d[a] = length * heading[a];
    }
    const State reached = convert(model, s, x, d);
    f(s, x, d, reached);
    s = reached;
    x = x + d;
  }
}

bool is_rest(const State& s) {
  return std::all_of(s.begin(), s.end(), [](double v) { return v == 0; });
}

}  // namespace

TEST_CASE("pictures join the atoms that are bonded") {
  for (const Source* source : {&kButane, &kDipeptide, &kEnkephalin}) {
    const Molecule molecule = source->read();
    hapgrid::Scene scene;
    scene.spheres = source->make()->info().spheres;
    hapgrid::Frame frame;
    for (const Eigen::Vector3d& at : molecule.conformation)
      for (const double x : at) frame.centres.push_back(static_cast<float>(x));
    std::vector<std::pair<int, int>> bonds;
    for (const auto& [a, b] : hapgrid::find_bonds(scene, frame)) bonds.emplace_back(a, b);
    CHECK(bonds == molecule.bonds);
  }
}

TEST_CASE("torsions and the energy of the molecule itself") {
  const std::vector<std::string> names{"phi 2 4 5 6", "psi 4 5 7 8"};
  const auto model = kDipeptide.make({{"torsions", names}, {"morph_stiffness", 50.0}});
  REQUIRE(model->info().torsions.size() == 2);
  CHECK(model->info().torsions[1].name == "psi");
  CHECK(model->info().torsions[1].spheres == std::array<std::uint32_t, 4>{3, 4, 6, 7});
  // At a path's end it is that of the file's last frame, wherever the molecule is.
  const Molecule molecule = kDipeptide.read();
  REQUIRE(model->has_own_energy());
  for (std::size_t k = 0; k < 4; ++k) {
    State s(10);
    s[k] = 1;
    s[4] = 2;
    s[9] = 0.5;
    CHECK(model->own_energy(s.data()) == Approx(molecule.paths[k].energies.back()).epsilon(1e-9));
  }
}

TEST_CASE("without contact the model knows the state 0 and stays there") {
  const auto model = kDipeptide.make();
  const State rest(10);
  CHECK(model->known_states({9, 9, 9}) == rest);
  CHECK(model->known_states({0, 0, 0}).empty());
  CHECK(is_rest(convert(*model, rest, {9, 9, 9}, {-1, 1, 0})));
  // Through the molecule in one go and out again.
  CHECK(is_rest(convert(*model, rest, {9, 9, 9}, {0, 0, 1})));
  Vec3 f = model->force({9, 9, 9}, rest.data());
  CHECK((f == Vec3{0, 0, 0}));
}

TEST_CASE("a held atom is pulled by its tie, and the molecule that has no other shape follows") {
  // Tie and anchor are two springs in a row along the axis: F d / √(d² + a²) = 20 shift.
  const std::string dioxide = "3\ndE=0\nC 0 0 0\nO 0 0 1.16\nO 0 0 -1.16\n";
  const auto model = hapgrid::Plugin("molecule", {HAPGRID_BUILD_DIR "/models"})
                         .create({{"conformation", dioxide}, {"hold", std::vector<double>{2}}});
  const State rest = model->known_states({0, 0, 1.16});
  CHECK(is_rest(rest));
  const State pulled = convert(*model, rest, {0, 0, 1.16}, {0, 0, 2});
  const double left = 2 - pulled[2], force = 40 * left / std::hypot(left, 0.5);
  CHECK(20 * pulled[2] == Approx(force).epsilon(1e-4));
  CHECK(model->force({0, 0, 3.16}, pulled.data())[2] == Approx(-0.025 * force).epsilon(1e-4));
  CHECK(model->equal(model->known_states({0, 0, 3.16}).data(), pulled.data()));
}

TEST_CASE("a held atom leads dichloroethane over its barrier and back, and what is fixed stays") {
  const auto model =
      Source{"dichloroethane", {"turn.xyz"}}.make({{"morph_stiffness", 0.0},
                                                   {"hold", std::vector<double>{4}},
                                                   {"hold_width", 0.5},
                                                   {"fixed", std::vector<double>{1, 2, 5, 6}},
                                                   {"shift_stiffness", 1000.0},
                                                   {"rotation_stiffness", 5000.0}});
  std::vector<float> centres(24);
  const auto place = [&](double t) {  // of the chlorine atom, where the shape is this one
    State s(7);
    s[0] = t;
    model->shape({}, s.data(), centres);
    return Vec3{centres[9], centres[10], centres[11]};
  };
  State s(7);
  Vec3 x = place(0);
  const std::array<float, 3> rest_chlorine{centres[0], centres[1], centres[2]};
  const auto to = [&](double t) {
    const Vec3 next = place(t);
    s = convert(*model, s, x, {next[0] - x[0], next[1] - x[1], next[2] - x[2]});
    x = next;
    CHECK(s[0] == Approx(t).margin(0.03));
    model->shape(x, s.data(), centres);
    CHECK(std::hypot(centres[0] - rest_chlorine[0], centres[1] - rest_chlorine[1],
                     centres[2] - rest_chlorine[2]) < 0.15);
  };
  for (int k = 1; k <= 20; ++k) to(k * 0.02);
  for (int k = 19; k >= -20; --k) to(k * 0.02);
}

TEST_CASE("a molecule without paths is pushed as a whole, also when it lies on a line") {
  const std::string dioxide = "3\ndE=0\nC 0 0 0\nO 0 0 1.16\nO 0 0 -1.16\n";
  const auto model = hapgrid::Plugin("molecule", {HAPGRID_BUILD_DIR "/models"})
                         .create({{"conformation", dioxide}});
  REQUIRE(model->state_size() == 6);
  // The probe stands on the axis and overlaps the oxygen of the molecule at rest by o: penalty and
  // anchor are two springs in a row, of 100 and 20 kJ/(mol Å²). States are rounded to 2^-20, and a
  // minimum has a gradient below 1e-3.
  const double overlap = 1.16 + 1.52 + 1.2 - 3.5, shift = 100 * overlap / 120;
  const State pushed = convert(*model, State(6), {0, 0, 5}, {0, 0, -1.5});
  for (std::size_t i = 0; i < 6; ++i) CHECK(pushed[i] == Approx(i == 2 ? -shift : 0).margin(2e-5));
  CHECK(model->force({0, 0, 3.5}, pushed.data())[2] == Approx(0.025 * 20 * shift).epsilon(1e-4));
  std::vector<float> centres(9);
  model->shape({0, 0, 3.5}, pushed.data(), centres);
  CHECK(centres[5] == Approx(1.16 - shift).epsilon(1e-4));
}

TEST_CASE("states that are reached are minima in multiples of 2^-20, with t in [0, 1]") {
  for (const Source& source : {kButane, kDipeptide}) {
    const auto model = source.make();
    HybridEnergy energy(source.read(), {});
    const std::size_t n = energy.variables(), paths = source.paths.size();
    Random random(9);
    int touched = 0;
    walk(*model, 4, 10, 400, 0.5, [&](const State&, const Vec3& x, const Vec3& d, const State& s) {
      const Vec3 p = x + d;
      for (std::size_t k = 0; k < paths; ++k) CHECK((s[k] >= 0 && s[k] <= 1));
      for (const double v : s) {
        CHECK(std::nearbyint(v * 0x1p20) == v * 0x1p20);
        CHECK(!(v == 0 && std::signbit(v)));
      }
      // A shift of zero stays. A gradient of 1e-3 kJ/(mol Å) is left, which is 5e-3 Å where H is as
      // soft as 0.2 kJ/(mol Å²).
      const State again = convert(*model, s, p, {0, 0, 0});
      CHECK(energy.displacement(s.data(), again.data()) < 5e-3);
      const double least = energy.value(s.data(), p.data());
      if (!energy.touches()) return;
      ++touched;
      std::vector<double> g(n), h(n * n);
      energy.derivatives(g.data(), h.data(), true);
      for (std::size_t i = 0; i < n; ++i) {
        const bool held = i < paths && ((s[i] == 0 && g[i] > 0) || (s[i] == 1 && g[i] < 0));
        // The minimiser's bound, and the rounding of every variable, times the curvature.
        double bound = hapgrid::molecule::MinimiserLimits().tolerance;
        for (std::size_t j = 0; j < n; ++j)
          bound += std::abs(h[i * n + j]) / energy.scale(i) * hapgrid::molecule::kStateUnit / 2;
        if (!held) CHECK(std::abs(g[i]) / energy.scale(i) < 1.01 * bound);
      }
      // Nothing in the neighbourhood is lower, by more than what is left of the gradient.
      for (int trial = 0; trial < 50; ++trial) {
        State other = s;
        const double size = trial % 2 ? 0.01 : 0.002;
        for (std::size_t i = 0; i < n; ++i)
          other[i] += random.between(-size, size) / energy.scale(i);
        for (std::size_t k = 0; k < paths; ++k) other[k] = std::clamp(other[k], 0.0, 1.0);
        CHECK(energy.value(other.data(), p.data()) > least - 2e-3 * size * static_cast<double>(n));
      }
    });
    CHECK(touched > 50);
  }
}

TEST_CASE("the minimum is where a plain descent in tiny steps arrives") {
  const auto model = kButane.make();
  HybridEnergy energy(kButane.read(), {});
  const std::size_t n = energy.variables(), paths = kButane.paths.size();
  int compared = 0, apart = 0;
  walk(*model, 4, 11, 150, 0.2,
       [&](const State& from, const Vec3& x, const Vec3& d, const State& reached) {
         if (is_rest(reached)) return;
         // The HIP in ten steps; at each the state slides down the scaled gradient, no move longer
         // than 0.002 Å, until the gradient is gone.
         State s = from;
         std::vector<double> g(n), h(n * n);
         for (int part = 1; part <= 10; ++part) {
           const Vec3 p = x + part / 10.0 * d;
           for (int step = 0; step < 20000; ++step) {
             energy.value(s.data(), p.data());
             energy.derivatives(g.data(), h.data(), true);
             double norm = 0;
             for (std::size_t i = 0; i < n; ++i) {
               g[i] /= energy.scale(i);
               if (i < paths && ((s[i] == 0 && g[i] > 0) || (s[i] == 1 && g[i] < 0))) g[i] = 0;
               norm += g[i] * g[i];
             }
             norm = std::sqrt(norm);
             if (norm < 1e-4) break;
             const double size = std::min(0.002, 0.001 * norm);
             for (std::size_t i = 0; i < n; ++i) {
               s[i] -= size * g[i] / norm / energy.scale(i);
               if (i < paths) s[i] = std::clamp(s[i], 0.0, 1.0);
             }
           }
         }
         ++compared;
         apart += !model->equal(s.data(), reached.data());
       });
  REQUIRE(compared > 30);
  // At a tear-off the two may part: a descent in steps jumps a moment earlier or later.
  CHECK(apart <= compared / 50);
}

TEST_CASE("when the HIP has left, the molecule is back at rest") {
  for (const Source& source : kAll) {
    const auto model = source.make({{"morph_stiffness", 1.0}});
    int left = 0;
    walk(*model, 6, 13, 200, 0.5, [&](const State&, const Vec3& x, const Vec3& d, const State& s) {
      if (is_rest(s) || ++left > 20) return;
      // Straight away from the middle, in steps.
      Vec3 p = x + d;
      State now = s;
      for (int step = 0; step < 40; ++step) {
        const Vec3 out = 0.6 / length_of(p) * p;
        now = convert(*model, now, p, out);
        p = p + out;
      }
      CHECK(is_rest(now));
    });
    CHECK(left > 10);
  }
}

TEST_CASE("a conversion depends on its arguments alone") {
  const auto one = kDipeptide.make(), other = kDipeptide.make();
  std::vector<std::tuple<State, Vec3, Vec3, State>> calls;
  walk(*one, 4, 14, 300, 0.5, [&](const auto&... call) { calls.emplace_back(call...); });
  // Backwards, and by another model.
  std::reverse(calls.begin(), calls.end());
  for (const auto& [s, x, d, reached] : calls)
    for (Model* model : {one.get(), other.get()}) CHECK(convert(*model, s, x, d) == reached);
}

TEST_CASE("equal states are no farther apart than the tolerance, and it is symmetric") {
  const auto model = kDipeptide.make();
  HybridEnergy energy(kDipeptide.read(), {});
  Random random(16);
  int same = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const State a = random.state(energy);
    State b = a;
    const double size = random.between(0, 0.08);
    for (double& v : b) v += random.between(-size, size);
    for (std::size_t k = 0; k < 4; ++k) b[k] = std::clamp(b[k], 0.0, 1.0);
    const bool equal = model->equal(a.data(), b.data());
    same += equal;
    CHECK(equal == model->equal(b.data(), a.data()));
    CHECK(equal == (rmsd(positions(energy, a), positions(energy, b)) <= 0.1));
    CHECK(model->equal(a.data(), a.data()));
  }
  CHECK((same > 100 && same < 1900));
}

TEST_CASE("force and energy are finite whatever the state") {
  const auto model = kDipeptide.make();
  Random random(18);
  const double odd[] = {std::nan(""), INFINITY, -INFINITY, 1e300, -1e300, 1e9, 5e-324, 0};
  for (int trial = 0; trial < 5000; ++trial) {
    State s(10);
    for (double& v : s) v = random.below(2) ? odd[random.below(8)] : random.between(-2, 2);
    const Vec3 f = model->force({random.between(-3, 3), 0, 0}, s.data());
    for (const double v : f) CHECK(std::isfinite(v));
  }
}
