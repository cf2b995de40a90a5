// What the reader takes; tests/cli/molecule/refuse.sh has what it refuses.
#include "tools/apps/molecule/input.hpp"

#include <locale>

#include "tests/unit/catch.hpp"
#include "tests/unit/molecule/reference.hpp"

using namespace molecules;

namespace {

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

/// The transition state with another title.
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
