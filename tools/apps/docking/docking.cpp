// A ligand in a host (docking): the HIP is the ligand's centre, its orientation is the state, and
// so are the angles of its softest bonds.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <hapgrid/plugin.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "tools/apps/docking/pose.hpp"

namespace {

using namespace hapgrid::docking;
namespace table = hapgrid::table;

constexpr double kMaxShift = 8;                                // angstrom
constexpr double kGoldenAngle = 2.39996, kHalfTurn = 3.14159;  // rad

std::vector<table::Lattice> read_maps(const std::vector<std::string>& texts) {
  std::vector<table::Lattice> maps;
  for (std::size_t m = 0; m < texts.size(); ++m)
    maps.push_back(table::read_lattice(texts[m], "map " + std::to_string(m + 1)));
  if (maps.empty()) throw std::runtime_error("maps: there are none");
  return maps;
}

/// With its softest bonds.
Ligand soft_ligand(const std::string& pdbqt, double torsions, double soft) {
  if (!(torsions >= 0 && torsions <= kMostTorsions && torsions == std::floor(torsions)))
    throw std::runtime_error("parameter torsions must be a whole number from 0 to " +
                             std::to_string(kMostTorsions));
  Ligand ligand = read_ligand(pdbqt);
  const std::vector<std::size_t> kept =
      softest_torsions(ligand, static_cast<std::size_t>(torsions), soft);
  keep_torsions(ligand, kept);
  return ligand;
}

using State = std::array<double, 6 + kMostTorsions>;

/// What the definition gives that all models of a program with the same ligand in the same host
/// have in common.
struct Given {
  double soft, torsions;
  std::string ligand, host, wall;
  std::vector<std::string> types, maps;
  bool operator==(const Given&) const = default;
};

/// The energy of the deepest orientation at each point of the grid, and a smooth function through
/// these: what a ligand has inside atoms, whatever its orientation.
struct Wall {
  table::Lattice lattice;
  table::Spline spline;
};

/// Each thread has a model, and `verify` makes them several times: reading the maps and seeking the
/// deepest orientations takes longer than the rest of what it does.
struct Site {
  Given given;
  Poses poses;
  std::vector<table::Atom> atoms;  // of the host, for pictures
  Wall wall;                       // without points when none is given
  std::mutex lock{};
  std::map<table::Spline::Counts, State> deepest{};  // at points of the wall, when they are needed
};

Wall read_wall(const std::string& text) {
  if (text.empty()) return {};
  Wall wall{table::read_lattice(text, "wall"), {}};
  for (const double value : wall.lattice.values)
    if (!std::isfinite(value)) throw std::runtime_error("wall: a value is missing");
  wall.spline = table::Spline(wall.lattice.counts, wall.lattice.values);
  return wall;
}

std::shared_ptr<Site> site_of(hapgrid::PluginParameters& parameters) {
  const bool by_atoms = parameters.has("host");
  Given given{parameters.positive("soft", 20),
              parameters.number("torsions", 0),
              parameters.text("ligand", ""),
              parameters.text("host", ""),
              parameters.text("wall", ""),
              {},
              {}};
  if (!by_atoms) given.types = parameters.texts("types"), given.maps = parameters.texts("maps");

  static std::mutex lock;
  static std::shared_ptr<Site> last;
  const std::lock_guard<std::mutex> guard(lock);
  if (last && last->given == given) return last;
  Ligand body = soft_ligand(given.ligand, given.torsions, given.soft);
  Wall wall = read_wall(given.wall);
  if (by_atoms) {
    const std::vector<Atom> host = read_host(given.host);
    std::vector<table::Atom> atoms;
    atoms.reserve(host.size());
    for (const Atom& atom : host) atoms.push_back({atom.type, atom.place});
    Poses poses(std::move(body), host, given.soft);
    last.reset(new Site{std::move(given), std::move(poses), std::move(atoms), std::move(wall)});
  } else {
    const std::vector<table::Lattice> maps = read_maps(given.maps);
    Poses poses(std::move(body), given.types, maps, given.soft);
    last.reset(new Site{std::move(given), std::move(poses), maps[0].atoms, std::move(wall)});
  }
  return last;
}

class DockingModel {
 public:
  explicit DockingModel(hapgrid::PluginParameters& parameters)
      : site_(site_of(parameters)),
        poses_(site_->poses),
        size_(poses_.ligand().state_size()),
        highest_(parameters.number("highest", 0)),
        tolerance_(parameters.positive("tolerance", 0.1)),
        substep_(parameters.positive("substep", 0.1)),
        force_scale_(parameters.positive("force_scale", 0.02)) {
    parameters.finish();
  }

  hapgrid_model_info info() const {
    hapgrid_model_info info{};
    info.state_size = static_cast<std::uint32_t>(size_);
    info.d_max = kMaxShift;
    info.tolerance = tolerance_;
    std::snprintf(info.tolerance_unit, sizeof info.tolerance_unit, "angstrom RMSD");
    std::snprintf(info.length_unit, sizeof info.length_unit, "angstrom");
    std::snprintf(info.energy_unit, sizeof info.energy_unit, "kJ/mol");
    info.force_scale = force_scale_;
    info.spheres = static_cast<std::uint32_t>(poses_.ligand().atoms.size() + site_->atoms.size());
    return info;
  }

  void periods(double* periods) const {
    std::fill_n(periods, 6, HAPGRID_ROTATION);
    for (const Torsion& torsion : poses_.ligand().torsions)
      periods[6 + (&torsion - &poses_.ligand().torsions[0])] = torsion.period;
  }

  /// Those of the minima at x that are not inside atoms, or else the deepest one.
  std::vector<double> known_states(const double* x) const {
    const std::vector<double> known = minima(x);
    std::vector<double> levels;
    for (std::size_t k = 0; k < known.size(); k += size_)
      if (poses_.energy(x, &known[k], nullptr) <= highest_)
        levels.insert(levels.end(), &known[k], &known[k] + size_);
    if (!levels.empty()) return levels;
    const State only = deepest_of(x, known);
    return {only.begin(), only.begin() + static_cast<std::ptrdiff_t>(size_)};
  }

  void convert(const double* s, const double* x, const double* d, double* result) const {
    std::copy_n(s, size_, result);
    const double way = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const int steps = static_cast<int>(std::ceil(way / substep_ - 1e-9));
    for (int k = 1; k <= steps; ++k) {
      const double part = static_cast<double>(k) / steps;
      const double at[3] = {x[0] + part * d[0], x[1] + part * d[1], x[2] + part * d[2]};
      poses_.relax(at, result);
      if (has_wall() && poses_.energy(at, result, nullptr) > highest_) give_way(at, result);
    }
    if (steps > 0) poses_.choose(result);
  }

  bool equal(const double* a, const double* b) const {
    return std::equal(a, a + size_, b) || poses_.ligand().distance(a, b) <= tolerance_;
  }

  /// At a minimum the energy does not change with the orientation, so its slope by x alone is the
  /// slope along the branch.
  void force(const double* x, const double* s, double* f) const {
    energy_and_slope(x, s, f);
    for (int a = 0; a < 3; ++a) f[a] *= -force_scale_;
  }

  double energy(const double* x, const double* s) const { return energy_and_slope(x, s, nullptr); }

  void spheres(hapgrid_sphere* spheres) const {
    const auto show = [&](const std::string& type, float size) {
      const std::string element = element_of(type);
      hapgrid_sphere& sphere = *spheres++;
      table::look_of(element, sphere.radius, sphere.colour);
      sphere.radius *= size;
      std::snprintf(sphere.label, sizeof sphere.label, "%s", element.c_str());
    };
    for (const Atom& atom : poses_.ligand().atoms) show(atom.type, 0.5F);
    for (const table::Atom& atom : site_->atoms) show(atom.label, 0.2F);
  }

  void shape(const double* x, const double* s, float* centres) const {
    std::array<Vector, kMostAtoms> places;
    poses_.places(x, s, places.data());
    for (std::size_t i = 0; i < poses_.ligand().atoms.size(); ++i)
      for (const double c : places[i]) *centres++ = static_cast<float>(c);
    for (const table::Atom& atom : site_->atoms)
      for (const double c : atom.position) *centres++ = static_cast<float>(c);
  }

 private:
  static constexpr int kStarts = 60;
  static constexpr double kRim = 10;  // kJ/mol above `highest`, over which a pose becomes wall

  bool has_wall() const { return !site_->given.wall.empty(); }

  /// That of the pose, which goes over into the wall's while the pose's rises by kRim above
  /// `highest`. At the points of the grid both are the same.
  double energy_and_slope(const double* x, const double* s, double* slope) const {
    const double own = poses_.energy(x, s, slope);
    if (!has_wall() || own <= highest_) return own;
    const table::Lattice& lattice = site_->wall.lattice;
    const table::Spline::Value wall = site_->wall.spline.at(lattice.coordinates(x));
    const double way = std::min((own - highest_) / kRim, 1.0);
    const double part = way * way * (3 - 2 * way), steep = 6 * way * (1 - way) / kRim;
    const Vector along = lattice.gradient(wall.gradient);
    for (int a = 0; slope && a < 3; ++a)
      slope[a] += part * (along[a] - slope[a]) + steep * (wall.value - own) * slope[a];
    return own + part * (wall.value - own);
  }

  /// Comes to rest from the orientation in the ligand's file and many others, and takes what
  /// differs.
  std::vector<double> minima(const double* x) const {
    std::vector<double> known;
    const int turns = static_cast<int>(size_) - 6, starts = kStarts * (1 + turns);
    for (int n = -1; n < starts; ++n) {
      double s[6 + kMostTorsions] = {1, 0, 0, 0, 1, 0};
      // Axes on a spiral around the sphere by the golden angle, which spreads them evenly, and
      // angles up to pi in another order: 11 and their number have no common factor.
      const double z = 1 - (2 * n + 1.0) / starts, r = std::sqrt(std::max(0.0, 1 - z * z)),
                   turned = kGoldenAngle * n;
      const double angle = kHalfTurn * ((n * 11) % starts + 0.5) / starts;
      const double turn[3] = {angle * r * std::cos(turned), angle * r * std::sin(turned),
                              angle * z};
      if (n >= 0) hapgrid::orientation::turn(s, turn);
      for (int t = 0; t < turns && n >= 0; ++t)  // multiples of irrational numbers spread evenly
        s[6 + t] = std::fmod(n * kGoldenAngle * std::sqrt(2.0 + t), 2 * kHalfTurn);
      poses_.relax(x, s);
      poses_.choose(s);
      bool is_new = true;
      for (std::size_t k = 0; k < known.size(); k += size_) is_new = is_new && !equal(&known[k], s);
      if (is_new) known.insert(known.end(), s, s + size_);
    }
    return known;
  }

  /// Turns s over to the deepest orientation at the nearest point of the grid, if that lies deeper
  /// at x. Inside the host a ligand has hundreds of minima, which mean nothing, since no ligand
  /// goes there: one is enough.
  void give_way(const double* x, double* s) const {
    const table::Lattice& lattice = site_->wall.lattice;
    const Vector at = lattice.coordinates(x);
    table::Spline::Counts point{};
    for (int a = 0; a < 3; ++a)
      point[a] = static_cast<std::size_t>(
          std::clamp(std::round(at[a]), 0.0, static_cast<double>(lattice.counts[a] - 1)));
    State other = deepest(point);
    poses_.relax(x, other.data());
    if (poses_.energy(x, other.data(), nullptr) < poses_.energy(x, s, nullptr))
      std::copy_n(other.data(), size_, s);
  }

  State deepest(const table::Spline::Counts& point) const {
    {
      const std::lock_guard<std::mutex> guard(site_->lock);
      const auto found = site_->deepest.find(point);
      if (found != site_->deepest.end()) return found->second;
    }
    const Vector at = site_->wall.lattice.place(point);
    const State state = deepest_of(at.data(), minima(at.data()));
    const std::lock_guard<std::mutex> guard(site_->lock);
    site_->deepest.emplace(point, state);
    return state;
  }

  /// Of states one after the other.
  State deepest_of(const double* x, const std::vector<double>& states) const {
    State state{};
    double best = 1e300;
    for (std::size_t k = 0; k < states.size(); k += size_) {
      const double energy = poses_.energy(x, &states[k], nullptr);
      if (energy < best) best = energy, std::copy_n(&states[k], size_, state.data());
    }
    return state;
  }

  std::shared_ptr<Site> site_;
  const Poses& poses_;
  std::size_t size_;
  double highest_, tolerance_, substep_, force_scale_;
};

}  // namespace

HAPGRID_MODEL_PLUGIN(DockingModel,
                     "a ligand that turns and bends in a host, by AutoDock's energies")
