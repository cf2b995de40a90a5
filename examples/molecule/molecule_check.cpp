// molecule-check: prints a table that shows whether a MODEL.toml of the molecule plug-in makes
// sense, or one shape of the molecule as XYZ, for other programs.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "examples/molecule/energy.hpp"
#include "examples/molecule/minima.hpp"
#include "examples/molecule/setup.hpp"
#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/box.hpp"
#include "tools/common/definition.hpp"
#include "tools/common/tool.hpp"

namespace {

using namespace hapgrid;
using namespace hapgrid::molecule;

// Atoms three bonds apart or more that are nearer than this share of the sum of their radii overlap
// more than in any molecule. The shapes on a path come from quantum chemistry. Nobody has computed
// those where two paths are combined: a clash there is a reason to drop one of the paths.
constexpr double kMinShareOnPath = 0.55;
constexpr double kMinShareOnPair = 0.4;
// Where more than two paths are combined: all corners of the cube of t while they are few, and
// random places.
constexpr std::size_t kMaxCornerPaths = 10;
constexpr int kRandomPlaces = 4000;
// How far the morph may be from a node, Å RMS: numbers are rounded, and the conformation has a file
// of its own.
constexpr double kMaxMiss = 1e-6;

struct Options {
  DefinitionOptions definition;
  std::vector<std::string> shape;
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

struct Pair {
  double share = std::numeric_limits<double>::infinity();  // of the sum of the radii
  double distance = 0;
  std::size_t a = 0, b = 0;
};

class Checker {
 public:
  Checker(const Definition& definition, const Setup& setup)
      : box_(definition.box), setup_(setup), energy_(setup.molecule, setup.energy) {
    const std::size_t n = molecule().atoms.size();
    separation_.assign(n * n, static_cast<int>(n));
    for (std::size_t i = 0; i < n; ++i) separation_[i * n + i] = 0;
    for (const auto& [a, b] : molecule().bonds) separation_[a * n + b] = separation_[b * n + a] = 1;
    for (std::size_t k = 0; k < n; ++k)  // Floyd and Warshall
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
          separation_[i * n + j] =
              std::min(separation_[i * n + j], separation_[i * n + k] + separation_[k * n + j]);
  }

  bool report() {
    const std::size_t paths = molecule().paths.size();
    std::printf("atoms              %zu, %zu bonds, radius of gyration %.2f Å\n",
                molecule().atoms.size(), molecule().bonds.size(), energy_.morph().gyration());
    std::printf("transition states  %zu\n\n", paths);
    std::printf("path  nodes  barrier   length    misses nodes by  nearest atoms\n");
    std::printf("             kJ/mol    Å RMS     Å RMS            Å, share of radii, at t\n");
    for (std::size_t k = 0; k < paths; ++k) {
      const Path& path = molecule().paths[k];
      const double miss = worst_miss(k);
      double at = 0;
      Pair nearest;
      for (int step = 0; step <= 100; ++step) {
        std::vector<double> t(paths);
        t[k] = place(k, step / 100.0);
        const Pair pair = nearest_pair(t);
        if (pair.share < nearest.share) nearest = pair, at = t[k];
      }
      std::printf("%-5zu %-6zu %-9.2f %-9.3f %-16.1e %s, %.2f\n", k, path.nodes.size(),
                  *std::max_element(path.energies.begin(), path.energies.end()),
                  energy_.morph().length(k), miss, describe(nearest).c_str(), at);
      expect(miss <= kMaxMiss, "path " + std::to_string(k) + " misses its nodes");
      expect(nearest.share >= kMinShareOnPath, "atoms overlap on path " + std::to_string(k) +
                                                   ": share below " +
                                                   std::to_string(kMinShareOnPath).substr(0, 4));
    }
    if (paths > 1) std::printf("\npaths combined     nearest atoms on an 11 x 11 lattice\n");
    for (std::size_t k = 0; k < paths; ++k)
      for (std::size_t l = k + 1; l < paths; ++l) report_pair(k, l);
    if (paths > 2) report_all();
    report_minima();
    report_box();
    for (const std::string& fault : faults_) std::printf("NOT SANE: %s\n", fault.c_str());
    return faults_.empty();
  }

  void print_xyz(const std::vector<double>& t) {
    const Positions p = shape(t);
    std::printf("%zu\ndE=%.4f t=", p.size(), energy_.shape_energy(t.data()));
    for (std::size_t k = 0; k < t.size(); ++k) std::printf("%s%g", k ? "," : "", t[k]);
    std::printf("\n");
    for (std::size_t i = 0; i < p.size(); ++i)
      std::printf("%-2s %15.8f %15.8f %15.8f\n", molecule().atoms[i]->symbol, p[i].x(), p[i].y(),
                  p[i].z());
  }

 private:
  const Molecule& molecule() const { return setup_.molecule; }
  void expect(bool good, const std::string& fault) {
    if (!good) faults_.push_back(fault);
  }
  std::string describe(const Pair& pair) const {
    char line[80];
    std::snprintf(line, sizeof line, "%.2f, %.2f %s%zu %s%zu", pair.distance, pair.share,
                  molecule().atoms[pair.a]->symbol, pair.a + 1, molecule().atoms[pair.b]->symbol,
                  pair.b + 1);
    return line;
  }

  Positions shape(const std::vector<double>& t) {
    std::vector<double> s = t;
    s.resize(energy_.variables());
    std::vector<double> p(3 * molecule().atoms.size());
    energy_.positions(s.data(), p.data());
    Positions positions;
    for (std::size_t i = 0; i < p.size(); i += 3) positions.emplace_back(p[i], p[i + 1], p[i + 2]);
    return positions;
  }

  /// The t_k at a share of its range, 0 to 1.
  double place(std::size_t k, double share) const { return energy_.low(k) + share; }

  /// The largest distance of a path's node from the morph's shape there, Å RMS. The node at t = 0
  /// is the conformation, which has a text of its own.
  double worst_miss(std::size_t k) {
    const Path& path = molecule().paths[k];
    double worst =
        aligned_rmsd(shape(std::vector<double>(molecule().paths.size())), molecule().conformation);
    for (std::size_t m = 0; m < path.nodes.size(); ++m) {
      if (m == path.start) continue;
      std::vector<double> t(molecule().paths.size());
      t[k] = path.t(m);
      worst = std::max(worst, aligned_rmsd(shape(t), path.nodes[m]));
    }
    return worst;
  }

  Pair nearest_pair(const std::vector<double>& t) {
    const Positions p = shape(t);
    const std::size_t n = p.size();
    Pair nearest;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = a + 1; b < n; ++b) {
        if (separation_[a * n + b] < 3) continue;
        const double distance = (p[a] - p[b]).norm();
        const double share = distance / (molecule().atoms[a]->radius + molecule().atoms[b]->radius);
        if (share < nearest.share) nearest = {share, distance, a, b};
      }
    return nearest;
  }

  void report_pair(std::size_t k, std::size_t l) {
    Pair nearest;
    double at[2] = {};
    for (int i = 0; i <= 10; ++i)
      for (int j = 0; j <= 10; ++j) {
        std::vector<double> t(molecule().paths.size());
        t[k] = place(k, i / 10.0);
        t[l] = place(l, j / 10.0);
        const Pair pair = nearest_pair(t);
        if (pair.share < nearest.share) nearest = pair, at[0] = t[k], at[1] = t[l];
      }
    std::printf("%zu and %zu            %s, at t = %.1f and %.1f\n", k, l,
                describe(nearest).c_str(), at[0], at[1]);
    expect(nearest.share >= kMinShareOnPair,
           "atoms overlap where paths " + std::to_string(k) + " and " + std::to_string(l) +
               " are combined: share below " + std::to_string(kMinShareOnPair).substr(0, 3));
  }

  /// The nearest atoms where all paths are combined. Half of the random places are on faces of the
  /// cube, where a molecule that is pushed hard is.
  void report_all() {
    const std::size_t paths = molecule().paths.size();
    Pair nearest;
    std::vector<double> at;
    const auto look = [&](const std::vector<double>& t) {
      const Pair pair = nearest_pair(t);
      if (pair.share < nearest.share) nearest = pair, at = t;
    };
    const std::size_t corner_paths = std::min(paths, kMaxCornerPaths);
    for (unsigned corner = 0; corner < 1U << corner_paths; ++corner) {
      std::vector<double> t(paths);
      for (std::size_t k = 0; k < paths; ++k)
        t[k] = place(k, k < corner_paths ? corner >> k & 1 : 1);
      look(t);
    }
    std::mt19937 random(1);
    const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
    for (int draw = 0; draw < kRandomPlaces; ++draw) {
      std::vector<double> t(paths);
      for (std::size_t k = 0; k < paths; ++k)
        t[k] = place(k, draw % 2 == 0 ? uniform() : std::clamp(2 * uniform() - 0.5, 0.0, 1.0));
      look(t);
    }
    std::string where;
    for (const double t : at) where += (where.empty() ? "" : ", ") + rounded(t);
    std::printf("all combined       %s, at t = %s\n", describe(nearest).c_str(), where.c_str());
    expect(nearest.share >= kMinShareOnPair,
           "atoms overlap where all paths are combined: share below " +
               std::to_string(kMinShareOnPair).substr(0, 3));
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

  void report_box() {
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
    std::printf(
        "\nbox                the probe in its corners is at least %.2f Å away from touching\n",
        clearance);
    expect(clearance > 0,
           "the probe touches the conformation in a corner of the box: make it larger");
  }

  const Box& box_;
  const Setup& setup_;
  HybridEnergy energy_;
  std::vector<int> separation_;  // in bonds, atoms x atoms
  std::vector<std::string> faults_;
};

int run(const Options& options) {
  const Definition definition = load_definition(options.definition);
  const Setup setup = setup_of(definition);
  Checker checker(definition, setup);
  if (options.shape.empty()) return checker.report() ? kExitDone : kExitFailed;
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
      "some\n"
      "paths are combined, and the box. The exit code is 1 when something is not sane."};
  app.set_help(
      "molecule-check",
      "A molecule is not sane when two atoms, at least three bonds apart, come nearer than 0.55 "
      "of\n"
      "the sum of their radii on a path, or 0.4 where paths are combined; when the morph "
      "misses\n"
      "a node by more than 1e-6 Å RMS; or when the probe touches the conformation in a corner of\n"
      "the box.\n");
  add_definition(app, options.definition);
  app.add("--xyz", options.shape,
          "Print the shape for these morphing parameters as XYZ instead, e.g. --xyz 0.5,0,0,1")
      .comma_separated();
  return run_tool(app, argc, argv, [&] { return run(options); });
}
