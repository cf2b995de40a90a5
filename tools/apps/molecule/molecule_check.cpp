// molecule-check: prints a table that shows whether a MODEL.toml of the molecule plug-in makes
// sense, or one shape of the molecule as XYZ, for other programs.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "libcore/base/error.hpp"
#include "libcore/base/json.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/box.hpp"
#include "tools/apps/molecule/energy.hpp"
#include "tools/apps/molecule/minima.hpp"
#include "tools/apps/molecule/sanity.hpp"
#include "tools/apps/molecule/setup.hpp"
#include "tools/common/definition.hpp"
#include "tools/common/tool.hpp"

namespace {

using namespace hapgrid;
using namespace hapgrid::molecule;

struct Options {
  std::string definition;
  std::vector<std::string> shape;
  std::string format = "text";
};

/// The parameters as a plug-in gets them.
Setup setup_of(const Definition& definition) {
  std::vector<hapgrid_parameter> parameters;
  std::vector<std::vector<const char*>> texts(definition.parameters.size());
  for (std::size_t i = 0; i < definition.parameters.size(); ++i) {
    const Parameter& given = definition.parameters[i];
    hapgrid_parameter p{given.key.c_str(), HAPGRID_NUMBER, 1, nullptr, nullptr};
    if (const auto* number = std::get_if<double>(&given.value)) {
      p.numbers = number;
    } else if (const auto* numbers = std::get_if<std::vector<double>>(&given.value)) {
      p.type = HAPGRID_NUMBERS;
      p.count = numbers->size();
      p.numbers = numbers->data();
    } else if (const auto* text = std::get_if<std::string>(&given.value)) {
      p.type = HAPGRID_TEXT;
      texts[i].push_back(text->c_str());
    } else if (const auto* list = std::get_if<std::vector<std::string>>(&given.value)) {
      p.type = HAPGRID_TEXTS;
      for (const std::string& entry : *list) texts[i].push_back(entry.c_str());
      p.count = list->size();
    } else {
      throw Error("parameter " + given.key + ": the molecule has no such switch");
    }
    if (!p.numbers) p.texts = texts[i].data();
    parameters.push_back(p);
  }
  PluginParameters reader(parameters.data(), parameters.size());
  return read_setup(reader);
}

class Checker {
 public:
  Checker(const Definition& definition, const Setup& setup)
      : box_(definition.box),
        setup_(setup),
        energy_(setup.molecule, setup.energy),
        sanity_(setup.molecule, energy_) {}

  bool report() {
    const std::size_t paths = molecule().paths.size();
    std::printf("atoms              %zu, %zu bonds, radius of gyration %.2f Å\n",
                molecule().atoms.size(), molecule().bonds.size(), energy_.morph().gyration());
    std::printf("transition states  %zu\n\n", paths);
    std::printf("path  nodes  barrier   length    misses nodes by  nearest atoms\n");
    std::printf("             kJ/mol    Å RMS     Å RMS            Å, share of radii, at t\n");
    for (std::size_t k = 0; k < paths; ++k) {
      const Path& path = molecule().paths[k];
      const AtomPair nearest = sanity_.nearest_on(k);
      std::printf("%-5zu %-6zu %-9.2f %-9.3f %-16.1e %s, %.2f\n", k, path.nodes.size(),
                  *std::max_element(path.energies.begin(), path.energies.end()),
                  energy_.morph().length(k), sanity_.worst_miss(k), describe(nearest).c_str(),
                  nearest.t[k]);
    }
    if (paths > 1 && !molecule().bonds_change)
      std::printf("\npaths combined     nearest atoms on an 11 x 11 lattice\n");
    for (std::size_t k = 0; k < paths && !molecule().bonds_change; ++k)
      for (std::size_t l = k + 1; l < paths; ++l) {
        const AtomPair nearest = sanity_.nearest_on(k, l);
        std::printf("%zu and %zu            %s, at t = %.1f and %.1f\n", k, l,
                    describe(nearest).c_str(), nearest.t[k], nearest.t[l]);
      }
    if (paths > 2 && !molecule().bonds_change) {
      const AtomPair nearest = sanity_.nearest_on_all();
      std::string where;
      for (const double t : nearest.t) where += (where.empty() ? "" : ", ") + rounded(t);
      std::printf("all combined       %s, at t = %s\n", describe(nearest).c_str(), where.c_str());
    }
    report_minima();
    const double clearance = this->clearance();
    std::printf("\nbox                ");
    if (setup_.energy.hold.empty())
      std::printf("the probe in its corners is at least %.2f Å away from touching\n", clearance);
    else
      std::printf("what is held rests at least %.2f Å inside it\n", clearance);
    const std::vector<Problem> problems = sanity_.problems();
    for (const Problem& problem : problems) std::printf("NOT SANE: %s\n", problem.line().c_str());
    if (!(clearance > 0)) std::printf("NOT SANE: %s\n", too_small());
    return problems.empty() && clearance > 0;
  }

  /// The same for programs: what they need of it.
  bool report_json() {
    nlohmann::ordered_json problems = nlohmann::ordered_json::array(), minima = problems;
    for (const Problem& problem : sanity_.problems())
      problems.push_back({{"paths", problem.paths}, {"what", problem.what}});
    if (!(clearance() > 0))
      problems.push_back({{"paths", nlohmann::ordered_json::array()}, {"what", too_small()}});
    for (const std::vector<double>& t : combined_minima(molecule()))
      minima.push_back({{"t", t}, {"energy_kJ_mol", energy_.shape_energy(t.data())}});
    const bool is_sane = problems.empty();
    const nlohmann::ordered_json all = {{"sane", is_sane},
                                        {"atoms", molecule().atoms.size()},
                                        {"paths", molecule().paths.size()},
                                        {"clearance_angstrom", clearance()},
                                        {"problems", problems},
                                        {"minima", minima}};
    std::fputs(json_text(all).c_str(), stdout);
    return is_sane;
  }

  void print_xyz(const std::vector<double>& t) {
    const Positions p = sanity_.shape(t);
    std::printf("%zu\ndE=%.4f t=", p.size(), energy_.shape_energy(t.data()));
    for (std::size_t k = 0; k < t.size(); ++k) std::printf("%s%g", k ? "," : "", t[k]);
    std::printf("\n");
    for (std::size_t i = 0; i < p.size(); ++i)
      std::printf("%-2s %15.8f %15.8f %15.8f\n", molecule().atoms[i]->symbol, p[i].x(), p[i].y(),
                  p[i].z());
  }

 private:
  const Molecule& molecule() const { return setup_.molecule; }
  std::string describe(const AtomPair& pair) const {
    if (!std::isfinite(pair.share)) return "none";
    char line[40];
    std::snprintf(line, sizeof line, "%.2f, %.2f ", pair.distance, pair.share);
    return line + sanity_.names(pair);
  }

  /// Where the molecule rests: the conformation and the combinations of minima behind saddles.
  void report_minima() {
    const auto all = combined_minima(molecule());
    if (all.size() == 1) return;
    std::printf("\nminima             kJ/mol    at t\n");
    for (const std::vector<double>& t : all) {
      std::printf("minimum            %-9.2f ", energy_.shape_energy(t.data()));
      for (std::size_t k = 0; k < t.size(); ++k) std::printf("%s%.9g", k ? "," : "", t[k]);
      std::printf("\n");
    }
  }

  const char* too_small() const {
    return setup_.energy.hold.empty()
               ? "the probe touches the conformation in a corner of the box: make it larger"
               : "what is held rests outside of the box: make it larger";
  }

  /// Of the probe in the corners of the box from the conformation, Å; of what is held in any
  /// minimum from the sides of the box.
  double clearance() {
    if (!setup_.energy.hold.empty()) return clearance_of_held();
    double clearance = std::numeric_limits<double>::infinity();
    for (unsigned corner = 0; corner < 8; ++corner) {
      GridCoordinates c{};
      for (int a = 0; a < 3; ++a) c[a] = corner >> a & 1 ? box_.counts[a] - 1 : 0;
      const Vec3 x = box_.position(c);
      for (std::size_t i = 0; i < molecule().atoms.size(); ++i) {
        const Eigen::Vector3d d = molecule().conformation[i] - Eigen::Vector3d(x.data());
        clearance = std::min(clearance,
                             d.norm() - molecule().atoms[i]->radius - setup_.energy.probe_radius);
      }
    }
    return clearance;
  }

  double clearance_of_held() {
    const Minima minima(molecule(), energy_);
    double clearance = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m < minima.size(); ++m) {
      const std::array<double, 3> at = minima.centre(m, setup_.energy.hold);
      for (int a = 0; a < 3; ++a) {
        const double low = at[a] - box_.origin[a];
        clearance = std::min({clearance, low, (box_.counts[a] - 1) * box_.spacing - low});
      }
    }
    return clearance;
  }

  const Box& box_;
  const Setup& setup_;
  HybridEnergy energy_;
  Sanity sanity_;
};

int run(const Options& options) {
  const Definition definition = load_definition({options.definition, {}}, "-");
  const Setup setup = setup_of(definition);
  Checker checker(definition, setup);
  if (options.shape.empty())
    return (options.format == "json" ? checker.report_json() : checker.report()) ? kExitDone
                                                                                 : kExitInvalid;
  if (options.shape.size() != setup.molecule.paths.size())
    throw Error("--xyz: " + std::to_string(options.shape.size()) + " numbers for " +
                std::to_string(setup.molecule.paths.size()) + " transition states");
  std::vector<double> shape;
  for (const std::string& text : options.shape) {
    char* end = nullptr;
    const double low = setup.molecule.paths[shape.size()].low();
    const double t = shape.emplace_back(std::strtod(text.c_str(), &end));
    if (*end || !(t >= low && t <= low + 1))
      throw Error("--xyz: numbers from " +
                  (low == 0 ? "0 to 1" : rounded(low) + " to " + rounded(low + 1)));
  }
  checker.print_xyz(shape);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CommandLine app{
      "Checks the molecule of a MODEL.toml: its paths, the nearest atoms on each path and where "
      "some "
      "paths are combined, and the box."};
  app.set_help("molecule-check",
               "A molecule is not sane when two atoms, at least three bonds apart, come nearer\n"
               "than 0.55 of the sum of their radii on a path, or 0.4 where paths are combined;\n"
               "when the morph misses a node by more than 1e-6 Å RMS; or when the probe touches\n"
               "the conformation in a corner of the box, or what is held is not inside.\n",
               "  3  read everything, and something is not sane\n");
  add_definition_file(app, options.definition);
  app.add("--format", options.format, "How the report is written")
      .one_of({"text", "json"})
      .shows_default();
  app.add("--xyz", options.shape,
          "Print the shape for these morphing parameters as XYZ instead, e.g. --xyz 0.5,0,0,1")
      .comma_separated();
  return run_tool(app, argc, argv, [&] { return run(options); });
}
