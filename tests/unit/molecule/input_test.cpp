// What the reader takes, and what it refuses: in one line that names the text, frame and atoms.
#include "tools/apps/molecule/input.hpp"

#include <locale>

#include "tests/unit/catch.hpp"
#include "tests/unit/molecule/reference.hpp"

using namespace molecules;
using Catch::Matchers::Equals;
using Catch::Matchers::StartsWith;

namespace {

const std::string kWater3 = "3\nwater\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n";
const std::string kPeroxide =
    "4\nE=-151.0\n"
    "O 0.0000 0.7300 -0.0500\nO 0.0000 -0.7300 -0.0500\n"
    "H 0.8000 0.9000 0.4000\nH -0.8000 -0.9000 0.4000\n";
// trans, higher
const std::string kTransPeroxide =
    "4\nE=-150.999\n"
    "O 0.0000 0.7300 -0.0500\nO 0.0000 -0.7300 -0.0500\n"
    "H 0.9100 0.9000 -0.0500\nH -0.9100 -0.9000 -0.0500\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

Molecule read(const std::string& conformation, const std::string& path,
              const std::vector<double>& energies = {}) {
  return read_molecule(conformation, {path}, energies);
}

/// The message that ends in "..." must only begin so.
void refused(const std::string& conformation, const std::string& path, const std::string& message) {
  INFO(conformation << path);
  if (message.size() > 3 && message.compare(message.size() - 3, 3, "...") == 0)
    CHECK_THROWS_WITH(read(conformation, path), StartsWith(message.substr(0, message.size() - 3)));
  else
    CHECK_THROWS_WITH(read(conformation, path), Equals(message));
}

/// The peroxide with another last hydrogen, and the transition state with another title.
std::string last_atom(const std::string& atom) {
  return replaced(kPeroxide, "H -0.8000 -0.9000 0.4000", atom);
}
std::string titled(const std::string& title) {
  return replaced(kTransPeroxide, "E=-150.999", title);
}

}  // namespace

TEST_CASE("a molecule of four atoms is read, its energy in hartree") {
  const Molecule molecule = read(kPeroxide, kTransPeroxide);
  CHECK(molecule.atoms.size() == 4);
  CHECK(molecule.bonds == std::vector<std::pair<int, int>>{{0, 1}, {0, 2}, {1, 3}});
  REQUIRE(molecule.paths.size() == 1);
  REQUIRE(molecule.paths[0].energies.size() == 2);
  CHECK(molecule.paths[0].energies[0] == 0);
  CHECK(molecule.paths[0].energies[1] == Approx(2.6255).epsilon(1e-4));
  CHECK(molecule.conformation[2].x() == 0.8);
  const auto barrier = [](const Molecule& m) { return m.paths[0].energies[1]; };
  // Both ways may stand if they agree; without the conformation's, E= says nothing.
  CHECK(barrier(read(kPeroxide, titled("dE=2.6 E=-150.999"))) == 2.6);
  CHECK(barrier(read(replaced(kPeroxide, "E=-151.0", "gauche"), titled("dE=12.5 E=-1"))) == 12.5);
  // As xtb writes it.
  CHECK(barrier(read(replaced(kPeroxide, "E=-151.0", " energy: -151.0 gnorm: 0.0002 xtb: 6.5.1"),
                     titled(" energy: -150.999 xtb: 6.5.1"))) == Approx(2.6255).epsilon(1e-4));
  CHECK(barrier(read(kPeroxide, titled("nothing"), {7})) == 7);
}

TEST_CASE("numbers are read the same whatever the locale") {
  const char* const previous = std::setlocale(LC_ALL, nullptr);
  const std::string kept = previous ? previous : "C";
  // Where it is not installed this tests nothing.
  const bool installed =
      std::setlocale(LC_ALL, "de_DE.UTF-8") || std::setlocale(LC_ALL, "cs_CZ.UTF-8");
  const Molecule molecule = read(kPeroxide, kTransPeroxide);
  std::setlocale(LC_ALL, kept.c_str());
  CHECK(molecule.conformation[0].y() == 0.73);
  CHECK(molecule.paths[0].energies[1] == Approx(2.6255).epsilon(1e-4));
  if (!installed) WARN("no locale with a decimal comma is installed");
}

TEST_CASE("texts that are no molecule are refused") {
  const struct {
    std::string conformation, message;
  } cases[] = {
      {"", "conformation: no frame of an XYZ text"},
      {"garbage\nmore\n",
       "conformation frame 1: no XYZ text: it must begin with a line that has the number of atoms"},
      {"4\nonly a title\n",
       "conformation frame 1: atom 1 is no line with a symbol and three numbers"},
      {kWater3, "conformation: 3 atoms have no torsion: transition_states must be empty"},
      {"1\nneon\nNe 0 0 0\n", "conformation frame 1: 1 atoms, at least 2 are needed"},
      {kPeroxide + kPeroxide, "conformation: 2 frames, it must be one"},
      {replaced(kPeroxide, "4\n", "4 atoms\n"),
       "conformation frame 1: no XYZ text: it must begin with a line that has the number of atoms"},
      {last_atom("H 8 8"),
       "conformation frame 1: atom 4 is no line with a symbol and three numbers"},
      {last_atom("H 8 8 8,1"),
       "conformation frame 1: atom 4 is no line with a symbol and three numbers"},
      {last_atom("H 8 8 8"), "conformation: not one molecule: no bonds lead from O1 to H4"},
      {last_atom("H 0.8 0.9 0.3"), "conformation frame 1: H3 and H4 are only 0.1 Å apart"},
      {last_atom("U -0.8 -0.9 0.4"),
       "conformation frame 1: atom 4 is no element whose van der Waals radius is known"},
  };
  for (const auto& c : cases) refused(c.conformation, kTransPeroxide, c.message);
  CHECK(read_molecule(kPeroxide, {}, {}).paths.empty());
}

TEST_CASE("transition states that do not belong to the conformation are refused") {
  refused(kPeroxide, "", "transition_states[0]: no frame of an XYZ text");
  refused(kButane.conformation(), kTransPeroxide,
          "transition_states[0] frame 1: 4 atoms, the conformation has 14");
  refused(kPeroxide, replaced(kTransPeroxide, "O 0.0000 -0.7300", "S 0.0000 -0.7300"),
          "transition_states[0] frame 1: atom 2 is S, in the conformation O; is the order of the "
          "atoms the same?");
  // The hydrogens are exchanged.
  refused(kPeroxide,
          "4\ndE=1\nO 0.0000 0.7300 -0.0500\nO 0.0000 -0.7300 -0.0500\n"
          "H -0.9100 -0.9000 -0.0500\nH 0.9100 0.9000 -0.0500\n",
          "transition_states[0] frame 1: O1 and H3 are bonded in the conformation but not here; is "
          "the order of the atoms the same?");
  refused(kPeroxide, replaced(kTransPeroxide, "0.9100", "nan"),
          "transition_states[0] frame 1: ...");
  // A path that starts elsewhere, or too high.
  refused(kPeroxide, titled("dE=0") + titled("dE=3"),
          "transition_states[0] frame 1: is not the conformation: 0....");
  refused(kPeroxide, replaced(kPeroxide, "E=-151.0", "dE=1") + titled("dE=3"),
          "transition_states[0] frame 1: is 1 kJ/mol above the conformation, where its path must "
          "start");
  // A frame that is cut off, and text behind the last one.
  const std::string path = text("butane", "C1-C2-C3-C4-plus.xyz");
  refused(kButane.conformation(), path.substr(0, path.size() - 60),
          "transition_states[0] frame 11: ...");
  refused(kButane.conformation(), path + "and more\n", "transition_states[0] frame 12: ...");
}

TEST_CASE("impossible energies are refused") {
  refused(kPeroxide, titled("trans"),
          "transition_states[0] frame 1: no energy: its title needs dE= (kJ/mol above the "
          "conformation) or E= (hartree)");
  refused(replaced(kPeroxide, "E=-151.0", "gauche"), kTransPeroxide,
          "transition_states[0] frame 1: its energy is absolute, but the conformation's title has "
          "no E= (hartree)");
  refused(kPeroxide, titled("dE=-3"),
          "transition_states[0] frame 1: the transition state is -3 kJ/mol above the conformation, "
          "it must be above 0");
  refused(kPeroxide, titled("dE=2.7 E=-150.999"),
          "transition_states[0] frame 1: dE= gives 2.7 kJ/mol above the conformation, E= gives "
          "2.6255: remove one");
  CHECK_THROWS_WITH(read(kPeroxide, kTransPeroxide, {1, 2}),
                    Equals("energies: 2 numbers for 1 transition states"));
  const std::string path = text("butane", "C1-C2-C3-C4-plus.xyz");
  const std::size_t third = path.rfind("dE=", path.find("t=0.2"));
  refused(kButane.conformation(),
          path.substr(0, third) + "dE=-0.5 " + path.substr(path.find("method=", third)),
          "transition_states[0] frame 3: is 0.5 kJ/mol below the conformation, which must be a "
          "minimum");
}

TEST_CASE("shapes without torsions") {
  // Butadiyne is a line.
  const std::string line =
      "6\ndE=0\nC 0 0 0.69\nC 0 0 -0.69\nC 0 0 1.89\nC 0 0 -1.89\nH 0 0 2.95\nH 0 0 -2.95\n";
  CHECK_THROWS_WITH(Morph(read(line, replaced(line, "dE=0", "dE=1"))),
                    Equals("conformation: all atoms lie on a line, it has no torsions"));
  const Molecule still = read(kPeroxide, replaced(kPeroxide, "E=-151.0", "dE=1"));
  CHECK_THROWS_WITH(Morph(still),
                    Equals("transition_states[0]: the transition state has the shape of "
                           "the conformation"));
}

TEST_CASE("parameters out of range are refused through the plug-in") {
  const auto refused = [](const char* key, double value, const std::string& line) {
    CHECK_THROWS_WITH(kButane.make({{key, value}}), Equals("model molecule: " + line));
  };
  refused("probe_radius", 0, "parameter probe_radius is 0, it must be from 0.1 to 10");
  refused("penalty", -1, "parameter penalty is -1, it must be from 1 to 100000");
  CHECK_THROWS_WITH(hapgrid::Plugin("molecule", {HAPGRID_BUILD_DIR "/models"}).create({}),
                    Equals("model molecule: parameter conformation is missing: an XYZ text"));
  // An exception of the plug-in with a C++ library of its own arrives as a line.
  CHECK_THROWS_WITH(hapgrid::Plugin("molecule", {HAPGRID_BUILD_DIR "/models"})
                        .create({{"conformation", std::string("garbage")},
                                 {"transition_states", std::vector<std::string>{"more"}}}),
                    Equals("model molecule: conformation frame 1: no XYZ text: it must begin with "
                           "a line that has the number of atoms"));
}
