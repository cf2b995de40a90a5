// A path that goes on behind its saddles: 1,2-dichloroethane, anti in the middle (t = 0), gauche on
// both sides. Energies and shapes of the nodes are GFN2-xTB's, from the committed texts.
#include "tests/unit/catch.hpp"
#include "tests/unit/molecule/reference.hpp"
#include "tools/apps/molecule/minima.hpp"

using namespace molecules;

namespace {

const Source kDichloroethane{"dichloroethane", {"turn.xyz"}};
const hapgrid::Parameter kUnlifted{"morph_stiffness", 0.0};

}  // namespace

TEST_CASE("a path behind its saddles has xtb's shapes and energies at all nodes") {
  const Molecule molecule = kDichloroethane.read();
  const std::string text = kDichloroethane.transition_states()[0];
  const std::vector<double> given = energies(text);
  const std::vector<Positions> shapes = frames(text);
  const hapgrid::molecule::Path& path = molecule.paths[0];
  REQUIRE(given.size() == path.nodes.size());
  CHECK(path.start == 27);
  CHECK(path.low() == -0.5);
  HybridEnergy energy(molecule, {});
  double length = 0;
  Positions before;
  for (std::size_t m = 0; m < given.size(); ++m) {
    State s(7);
    s[0] = path.t(m);
    CHECK(energy.shape_energy(s.data()) == Approx(given[m]).margin(1e-12));
    CHECK(superposed_rmsd(positions(energy, s), shapes[m]) < 1e-6);
    const Positions here = positions(energy, s);
    if (m > 0) length += rmsd(here, before);
    before = here;
  }
  CHECK(energy.morph().length(0) == Approx(length));
  // Outside its range t counts as the end, and NaN as the conformation.
  for (const double t : {-0.7, 0.6}) {
    const double end = t < 0 ? -0.5 : 0.5;
    CHECK(energy.shape_energy(&t) == energy.shape_energy(&end));
  }
}

TEST_CASE("all minima are known states, and the molecule rests in them") {
  const auto model = kDichloroethane.make({kUnlifted});
  const State known = model->known_states({6.5, 5.5, 6});
  REQUIRE(known.size() == 21);  // anti, and gauche on both sides
  CHECK(model->known_states({0, 0, 0}).empty());
  const std::vector<double> given = energies(kDichloroethane.transition_states()[0]);
  // The lowest nodes on either side.
  const double gauche[2] = {(10 - 27) / 54.0, (44 - 27) / 54.0};
  CHECK(given[10] == Approx(5.77).margin(0.005));
  for (int m = 0; m < 3; ++m) {
    const State state(known.begin() + 7 * m, known.begin() + 7 * (m + 1));
    CHECK(state[0] == Approx(m == 0 ? 0 : gauche[m - 1]).margin(0x1p-20));
    CHECK(convert(*model, state, {6.5, 5.5, 6}, {-1, 0, 0.5}) == state);
    // From nearby it comes back, to the last digit.
    State moved = state;
    moved[0] += 0.03, moved[2] -= 0.05, moved[5] += 0.04;
    CHECK(convert(*model, moved, {6.5, 5.5, 6}, {0, 0, 0}) == state);
  }
}

TEST_CASE("a path that leads round closes, and an atom that is held goes round and round") {
  const Source round{"held/dichloroethane", {"Cl1-C2-C3-Cl4.xyz"}};
  Molecule molecule = round.read();
  REQUIRE(molecule.paths[0].closes);
  // By mass the molecule would lie the other way round at the path's end.
  CHECK_FALSE(HybridEnergy(molecule, {}).closes(0));
  molecule.fixed = {0, 1, 2, 4, 5};
  HybridEnergy energy(molecule, {});
  REQUIRE(energy.closes(0));
  const auto shape = [&](double t) {
    State s(7);
    s[0] = t;
    return positions(energy, s);
  };
  for (const double t : {-0.3, 0.1, 0.49}) {
    CHECK(rmsd(shape(t), shape(t + 1)) < 1e-9);
    const double other = t - 1;
    CHECK(energy.shape_energy(&t) == Approx(energy.shape_energy(&other)).margin(1e-9));
  }
  // No kink where the ends meet: the differences on both sides are one, but for the curvature.
  constexpr double kStep = 1e-4;
  const Positions before = shape(0.5 - kStep), at = shape(0.5), after = shape(0.5 + kStep);
  for (std::size_t i = 0; i < at.size(); ++i)
    CHECK((after[i] - 2 * at[i] + before[i]).norm() < 1e-2 * (after[i] - before[i]).norm() + 1e-7);

  const auto model = round.make({kUnlifted,
                                 {"hold", std::vector<double>{4}},
                                 {"fixed", std::vector<double>{1, 2, 3, 5, 6}},
                                 {"shift_stiffness", 1000.0},
                                 {"rotation_stiffness", 5000.0}});
  State s(7);
  hapgrid::Vec3 x{at[3].x(), at[3].y(), at[3].z()};
  s[0] = -0.5;
  for (int k = 1; k <= 100; ++k) {  // twice
    const Eigen::Vector3d next = shape(-0.5 + 0.02 * k)[3];
    s = convert(*model, s, x, {next.x() - x[0], next.y() - x[1], next.z() - x[2]});
    x = {next.x(), next.y(), next.z()};
    const double off = s[0] - (-0.5 + 0.02 * k);
    CHECK(std::abs(off - std::round(off)) < 0.03);
    CHECK((s[0] >= -0.5 && s[0] <= 0.5));
  }
}
