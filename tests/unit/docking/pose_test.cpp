// A ligand that turns and whose bonds turn, against closed forms and differences.
#include "tools/apps/docking/pose.hpp"

#include <cstdio>
#include <hapgrid/plugin.hpp>

#include "tests/unit/catch.hpp"

using namespace hapgrid;
using Catch::Matchers::ContainsSubstring;

namespace {

constexpr double kPi = 3.14159265358979323846;

std::string atom(int number, const char* type, double x, double y, double z, double charge) {
  char line[100];
  std::snprintf(line, sizeof line,
                "ATOM  %5d  X   LIG A   1    %8.3f%8.3f%8.3f  0.00  0.00    %+6.3f %s\n", number, x,
                y, z, charge, type);
  return line;
}

/// Like water: a turn by pi around z carries it into itself. Its centre is the origin.
std::string water() {
  return atom(1, "OA", 0, 0, 0.8, -0.4) + atom(2, "HD", 1, 0, -0.4, 0.2) +
         atom(3, "HD", -1, 0, -0.4, 0.2);
}

/// A carboxylate, whose bond lies along x.
std::string carboxylate() {
  return "ROOT\n" + atom(1, "C", 0, 1.5, 0, 0) + atom(2, "C", 0, 0, 0, 0) +
         "ENDROOT\nBRANCH 2 3\n" + atom(3, "C", 1.5, 0, 0, 0.4) + atom(4, "OA", 2.1, 1.1, 0, -0.7) +
         atom(5, "OA", 2.1, -1.1, 0, -0.7) + "ENDBRANCH 2 3\n";
}

/// Like butanol: one bond beyond another.
std::string chain() {
  return "ROOT\n" + atom(1, "C", -0.5, 1.4, 0.3, 0.1) + atom(2, "C", 0, 0, 0, 0.1) +
         "ENDROOT\nBRANCH 2 3\n" + atom(3, "C", 1.5, 0, 0, 0.1) + atom(4, "A", 2, 1.4, 0, 0.1) +
         "BRANCH 4 5\n" + atom(5, "OA", 3.4, 1.4, 0.1, -0.5) + atom(6, "HD", 3.8, 1.9, 0.8, 0.3) +
         "ENDBRANCH 4 5\nENDBRANCH 2 3\n";
}

docking::Ligand with(const std::string& text, const std::vector<std::size_t>& torsions) {
  docking::Ligand ligand = docking::read_ligand(text);
  docking::keep_torsions(ligand, torsions);
  return ligand;
}

/// A map of 17 points a side, 1 angstrom apart, around the origin.
table::Lattice empty_map() {
  table::Lattice map;
  map.counts = {17, 17, 17};
  map.origin = {-8, -8, -8};
  for (int a = 0; a < 3; ++a) map.axes[a][a] = map.inverse[a][a] = 1;
  map.values.resize(17 * 17 * 17);
  return map;
}

/// Four atoms around the origin, at different distances.
std::vector<docking::Atom> cage() {
  return {{"OA", -0.4, {5.5, 0.3, 0}},
          {"C", 0.2, {-3, 5, 0.5}},
          {"HD", 0.3, {-2, -4.5, 3}},
          {"N", -0.2, {0.5, -1, -6}}};
}

}  // namespace

TEST_CASE("an orientation turns, and brings the places of a body along") {
  double columns[6] = {1, 0, 0, 0, 1, 0}, place[3];
  const double turn[3] = {0, 0, 0.7}, body[3] = {1, 2, 3};
  orientation::turn(columns, turn);
  orientation::apply(columns, body, place);
  CHECK(place[0] == Approx(std::cos(0.7) - 2 * std::sin(0.7)));
  CHECK(place[1] == Approx(std::sin(0.7) + 2 * std::cos(0.7)));
  CHECK(place[2] == 3);
  double skewed[6] = {2, 0, 0, 5, 3, 0};
  orientation::normalise(skewed);
  const double straight[6] = {1, 0, 0, 0, 1, 0};
  for (int k = 0; k < 6; ++k) CHECK(skewed[k] == Approx(straight[k]).margin(1e-15));
}

TEST_CASE("turns that carry a ligand into itself are no distance") {
  const docking::Ligand ligand = with(water(), {});
  CHECK(ligand.atoms.size() == 3);
  CHECK(ligand.symmetry.size() == 2);
  const double still[6] = {1, 0, 0, 0, 1, 0}, over[6] = {-1, 0, 0, 0, -1, 0};
  CHECK(ligand.distance(still, over) == Approx(0).margin(1e-7));  // the root of a rounding
  for (const double angle : {0.001, 0.4, 1.5}) {
    // Around z only the two atoms at a distance of 1 move, by 2 sin(angle / 2).
    double turned[6] = {1, 0, 0, 0, 1, 0};
    const double turn[3] = {0, 0, angle};
    orientation::turn(turned, turn);
    const double expected = std::sqrt(2.0 / 3) * 2 * std::sin(angle / 2);
    CHECK(ligand.distance(still, turned) == Approx(expected).epsilon(1e-6));
    CHECK(ligand.distance(over, turned) == Approx(expected).epsilon(1e-6));
  }
  const docking::Ligand other =
      with(atom(1, "OA", 0, 0, 0.8, -0.4) + atom(1, "HD", 1, 0, -0.4, 0.2) +
               atom(1, "HD", -1, 0, -0.4, 0.1),
           {});
  CHECK(other.symmetry.size() == 1);
}

TEST_CASE("around a ligand on one line nothing turns") {
  const docking::Ligand ligand = with(
      atom(1, "OA", 1.2, 0, 0, -0.4) + atom(1, "C", 0, 0, 0, 0.8) + atom(1, "OA", -1.2, 0, 0, -0.4),
      {});
  CHECK(std::abs(ligand.axis[0]) == Approx(1));
  CHECK(ligand.symmetry.size() == 2);
  const double still[6] = {1, 0, 0, 0, 1, 0}, around[6] = {1, 0, 0, 0, 0, 1};
  const double over[6] = {-1, 0, 0, 0, 1, 0}, across[6] = {0, 1, 0, -1, 0, 0};
  CHECK(ligand.distance(still, around) == Approx(0).margin(1e-7));
  CHECK(ligand.distance(still, over) == Approx(0).margin(1e-7));
  CHECK(ligand.distance(still, across) == Approx(std::sqrt(2.0 / 3) * 1.2 * std::sqrt(2.0)));
}

TEST_CASE("a bond that turns carries what lies beyond it, and the centre stays") {
  const docking::Ligand ligand = with(chain(), {0});
  REQUIRE(ligand.torsions.size() == 1);
  CHECK(ligand.torsions[0].moved == std::vector<std::size_t>{3, 4, 5});
  docking::Vector still[6], turned[6], sum{};
  const double zero = 0, angle = 0.8;
  ligand.bend(&zero, still);
  ligand.bend(&angle, turned);
  for (const docking::Vector& place : turned)
    for (int a = 0; a < 3; ++a) sum[a] += place[a];
  for (int a = 0; a < 3; ++a) CHECK(sum[a] == Approx(0).margin(1e-12));
  const auto away = [](const docking::Vector& a, const docking::Vector& b) {
    return docking::length(docking::minus(a, b));
  };
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < i; ++j)
      if ((i > 2) == (j > 2) || i == 2 || j == 1 || j == 2)  // in one piece, or on the axis
        CHECK(away(turned[i], turned[j]) == Approx(away(still[i], still[j])));
  // Atoms 0 and 3 lie at (-0.5, 1.4, 0.3) and 2 along x, at 1.4 from it in the direction of the
  // angle.
  CHECK(away(turned[0], turned[3]) ==
        Approx(std::sqrt(2.5 * 2.5 + std::pow(1.4 - 1.4 * std::cos(angle), 2) +
                         std::pow(0.3 - 1.4 * std::sin(angle), 2))));
}

TEST_CASE("half a turn of a carboxylate is none") {
  const docking::Ligand ligand = with(carboxylate(), {0});
  CHECK(ligand.torsions[0].period == Approx(kPi));
  CHECK(with(chain(), {1}).torsions[0].period == Approx(2 * kPi));
  const double still[7] = {1, 0, 0, 0, 1, 0, 0.2}, half[7] = {1, 0, 0, 0, 1, 0, 0.2 - kPi};
  const double quarter[7] = {1, 0, 0, 0, 1, 0, 0.2 + kPi / 2};
  CHECK(ligand.distance(still, half) == Approx(0).margin(1e-7));
  CHECK(ligand.distance(still, quarter) == Approx(std::sqrt(2.0 / 5) * 1.1 * std::sqrt(2.0)));
}

TEST_CASE("the derivatives of a pair's energy are its differences") {
  const docking::Ligand ligand = with(chain(), {0, 1});
  const std::vector<docking::Pair> pairs = docking::pairs_of(ligand);
  // More than three bonds lie between 1 and 5, 1 and 6, 2 and 6 alone.
  REQUIRE(pairs.size() == 3);
  for (const docking::Pair& pair : pairs)
    for (const double r : {0.8, 1.5, 2.4, 3.3, 4.4, 6.0}) {
      const double h = 1e-4;  // the error is about h^2 times the next derivative but one
      const auto low = pair.energy(r - h, 20), here = pair.energy(r, 20),
                 high = pair.energy(r + h, 20);
      const double scale = 1 + std::abs(here[1]) + std::abs(here[2]);
      CHECK(here[1] == Approx((high[0] - low[0]) / (2 * h)).margin(1e-5 * scale));
      CHECK(here[2] == Approx((high[1] - low[1]) / (2 * h)).margin(1e-5 * scale));
    }
}

TEST_CASE("a ligand leaves a ridge that is flat beside a stiff valley") {
  // Two atoms keep the ligand along x, with 500 kcal/mol for the square of an angstrom. Two others
  // turn around x, with 1e-4 y^2 kcal/mol: from the ridge at y = 1 and -1 to the valley at y = 0.
  std::vector<table::Lattice> maps(4, empty_map());
  for (std::size_t n = 0; n < maps[0].values.size(); ++n) {
    const double y = static_cast<double>(n / 17 % 17) - 8, z = static_cast<double>(n / 289) - 8;
    maps[0].values[n] = 500 * (y * y + z * z);
    maps[1].values[n] = 1e-4 * y * y;
  }
  const docking::Poses poses(with(atom(1, "C", 1, 0, 0, 0) + atom(2, "C", -1, 0, 0, 0) +
                                      atom(3, "N", 0, 1, 0, 0) + atom(4, "N", 0, -1, 0, 0),
                                  {}),
                             {"C", "N", "e", "d"}, maps, 1e9);
  const double x[3] = {0, 0, 0}, turn[3] = {1e-3, 0, 0};
  double s[6] = {1, 0, 0, 0, 1, 0};
  orientation::turn(s, turn);
  poses.relax(x, s);
  CHECK(std::abs(s[5]) == Approx(1));
}

TEST_CASE("the slope among the host's atoms is that of the energy, also where they overlap") {
  const docking::Poses poses(with(chain(), {0}), cage(), 20);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-6, 6);
  for (int n = 0; n < 50; ++n) {
    const double s[7] = {1, 0, 0, 0, 1, 0, uniform(random)};
    double x[3] = {uniform(random), uniform(random), uniform(random)}, slope[3];
    poses.energy(x, s, slope);
    for (int a = 0; a < 3; ++a) {
      const double h = 1e-5, here = x[a];
      x[a] = here + h;
      const double high = poses.energy(x, s, nullptr);
      x[a] = here - h;
      const double low = poses.energy(x, s, nullptr);
      x[a] = here;
      // An error of h^2 / 6 times the third derivative, and rounding of 1e-16 / h of the energy.
      CHECK(slope[a] == Approx((high - low) / (2 * h)).margin(1e-5 * (1 + std::abs(slope[a]))));
    }
  }
}

TEST_CASE("bonds are chosen by how little the energy changes around them") {
  const docking::Ligand ligand = docking::read_ligand(chain());
  // The hydrogen of the outer bond moves little; around the inner one two atoms meet the first one.
  CHECK(docking::softest_torsions(ligand, 1, 10) == std::vector<std::size_t>{1});
  CHECK(docking::softest_torsions(ligand, 2, 10) == std::vector<std::size_t>{0, 1});
  CHECK_THROWS_WITH(docking::softest_torsions(ligand, 3, 10),
                    ContainsSubstring("2 of its bonds turn"));
}
