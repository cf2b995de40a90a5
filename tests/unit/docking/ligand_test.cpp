// A ligand that turns, against closed forms.
#include <cstdio>
#include <hapgrid/plugin.hpp>

#include "tests/unit/catch.hpp"
#include "tools/apps/docking/pose.hpp"

using namespace hapgrid;
using Catch::Matchers::ContainsSubstring;

namespace {

std::string atom(const char* type, double x, double y, double z, double charge) {
  char line[100];
  std::snprintf(line, sizeof line,
                "ATOM      1  X   LIG A   1    %8.3f%8.3f%8.3f  0.00  0.00    %+6.3f %s\n", x, y, z,
                charge, type);
  return line;
}

/// Like water: a turn by pi around z carries it into itself. Its centre is the origin.
std::string water() {
  return atom("OA", 0, 0, 0.8, -0.4) + atom("HD", 1, 0, -0.4, 0.2) + atom("HD", -1, 0, -0.4, 0.2);
}

docking::Ligand rigid(const std::string& pdbqt) {
  docking::Ligand ligand = docking::read_ligand(pdbqt);
  docking::keep_torsions(ligand, {});
  return ligand;
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
  const docking::Ligand ligand = rigid(water());
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
  const docking::Ligand other = rigid(atom("OA", 0, 0, 0.8, -0.4) + atom("HD", 1, 0, -0.4, 0.2) +
                                      atom("HD", -1, 0, -0.4, 0.1));
  CHECK(other.symmetry.size() == 1);
}

TEST_CASE("around a ligand on one line nothing turns") {
  const docking::Ligand ligand =
      rigid(atom("OA", 1.2, 0, 0, -0.4) + atom("C", 0, 0, 0, 0.8) + atom("OA", -1.2, 0, 0, -0.4));
  CHECK(std::abs(ligand.axis[0]) == Approx(1));
  CHECK(ligand.symmetry.size() == 2);
  const double still[6] = {1, 0, 0, 0, 1, 0}, around[6] = {1, 0, 0, 0, 0, 1};
  const double over[6] = {-1, 0, 0, 0, 1, 0}, across[6] = {0, 1, 0, -1, 0, 0};
  CHECK(ligand.distance(still, around) == Approx(0).margin(1e-7));
  CHECK(ligand.distance(still, over) == Approx(0).margin(1e-7));
  CHECK(ligand.distance(still, across) == Approx(std::sqrt(2.0 / 3) * 1.2 * std::sqrt(2.0)));
}

TEST_CASE("what is no ligand is refused") {
  CHECK_THROWS_WITH(docking::read_ligand(atom("C", 0, 0, 0, 0)),
                    ContainsSubstring("fewer than two"));
  CHECK_THROWS_WITH(docking::read_ligand(atom("", 0, 0, 0, 0) + atom("C", 1, 0, 0, 0)),
                    ContainsSubstring("has no type"));
  CHECK_THROWS_WITH(docking::read_ligand("ATOM      1  X\n"), ContainsSubstring("is missing"));
  CHECK_THROWS_WITH(docking::read_ligand(water() + "BRANCH 1 7\nENDBRANCH 1 7\n"),
                    ContainsSubstring("an atom of a branch is missing"));
  CHECK_THROWS_WITH(
      docking::read_ligand("ATOM      2  X   LIG A   1       1.000   0.000  -0.400  0.00  "
                           "0.00    +0.200 HD\nBRANCH 2 1\n" +
                           atom("HD", 1, 0, -0.4, 0.2) + "ENDBRANCH 2 1\n"),
      ContainsSubstring("lie at one place"));
  CHECK_THROWS_WITH(docking::read_ligand("ENDBRANCH 1 2\n" + water()),
                    ContainsSubstring("never began"));
  std::string many;
  for (int n = 0; n < 201; ++n) many += atom("C", n, 0, 0, 0);
  CHECK_THROWS_WITH(docking::read_ligand(many), ContainsSubstring("more than 200"));
}

TEST_CASE("what is no host is refused") {
  CHECK(docking::read_host("REMARK\n" + water()).size() == 3);
  CHECK_THROWS_WITH(docking::read_host("nothing\n"), ContainsSubstring("host: it has no atoms"));
  CHECK_THROWS_WITH(docking::read_host(atom("", 0, 0, 0, 0)), ContainsSubstring("host: an atom"));
  std::string many;
  for (int n = 0; n < 501; ++n) many += atom("C", n, 0, 0, 0);
  CHECK_THROWS_WITH(docking::read_host(many), ContainsSubstring("host: it has more than 500"));
  CHECK_THROWS_WITH(docking::Poses(rigid(water()), {{"Zn", 2, {0, 0, 5}}}, 20),
                    ContainsSubstring("no parameters for atoms of type Zn"));
}
