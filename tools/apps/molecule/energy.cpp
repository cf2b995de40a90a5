#include "tools/apps/molecule/energy.hpp"

#include <algorithm>
#include <cmath>

#include "tools/apps/molecule/elementary.hpp"
#include "tools/apps/molecule/lanes.hpp"

namespace hapgrid::molecule {

namespace {

// Of paths that share an end only, kJ/(mol Å⁴): two atoms' places on both, 0.3 Å each, cost 8
// kJ/mol.
constexpr double kBranches = 1000;

double square(double v) { return v * v; }

double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void cross(const double* a, const double* b, double* c) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

}  // namespace

HybridEnergy::HybridEnergy(const Molecule& molecule, const EnergyParameters& parameters)
    : parameters_(parameters),
      morph_(molecule),
      variables_(morph_.paths() + 6),
      unit_(parameters.hold.empty() ? parameters.penalty : 1),
      shape_(morph_.make_shape()),
      other_(morph_.make_shape()),
      rotation_{},
      state_{},
      probe_{},
      contacts_(morph_.atoms()),
      pulls_(morph_.atoms()),
      velocity_(3 * morph_.paths()),
      bending_{} {
  for (std::size_t k = 0; k < morph_.paths(); ++k) scale_.push_back(morph_.length(k));
  scale_.insert(scale_.end(), 3, 1);
  scale_.insert(scale_.end(), 3, morph_.gyration());
  if (molecule.bonds_change && molecule.paths.size() > 1) branches_ = kBranches;
  for (const Path& path : molecule.paths) profiles_.emplace_back(path.energies, path.start);
  for (int a = 0; a < 3; ++a) centre_[a] = morph_.centre()[a];
  for (const int atom : morph_.tree().order)
    reach_.push_back(molecule.atoms[atom]->radius + parameters.probe_radius);
  const std::vector<int>& order = morph_.tree().order;
  for (const int atom : parameters.hold)
    held_.push_back(
        static_cast<std::size_t>(std::find(order.begin(), order.end(), atom) - order.begin()));
}

HybridEnergy::Rotation HybridEnergy::rotation(const double* vector) {
  // The anchor lets no molecule turn by 100 rad. A vector as long, or one that is not a number,
  // must not become a force: it counts as no rotation.
  static constexpr double kNone[3] = {0, 0, 0};
  double z = dot(vector, vector);
  const double* const v = z < 1e4 ? vector : kNone;
  if (v == kNone) z = 0;
  double a, b, c;  // sin θ / θ, (1 - cos θ) / θ², (1 - sin θ / θ) / θ²
  if (z < 0.01) {
    a = 1 - z / 6 * (1 - z / 20 * (1 - z / 42 * (1 - z / 72)));
    b = 0.5 - z / 24 * (1 - z / 30 * (1 - z / 56 * (1 - z / 90)));
    c = 1.0 / 6 - z / 120 * (1 - z / 42 * (1 - z / 72 * (1 - z / 110)));
  } else {
    const double angle = std::sqrt(z);
    const double angles[2] = {angle, angle / 2};
    double sines[2], cosines[2];
    sines_and_cosines(angles, sines, cosines, 2);
    a = sines[0] / angle;
    b = 2 * sines[1] * sines[1] / z;
    c = (1 - a) / z;
  }
  // [v]² = v vᵀ - |v|² 1
  Rotation r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double squared = v[i] * v[j] - (i == j ? z : 0);
      r.matrix[3 * i + j] = (i == j) + b * squared;
      r.rate[3 * i + j] = (i == j) + c * squared;
    }
  const auto add = [&](int i, int j, double turn) {
    r.matrix[3 * i + j] += a * turn;
    r.rate[3 * i + j] -= b * turn;
  };
  add(0, 1, -v[2]), add(0, 2, v[1]), add(1, 2, -v[0]);
  add(1, 0, v[2]), add(2, 0, -v[1]), add(2, 1, v[0]);
  return r;
}

/// Finds the shape of s. Not all atoms are moved to where s has them; the probe is moved into the
/// molecule's frame instead.
void HybridEnergy::place(const double* s, const double* x) {
  std::copy_n(s, variables_, state_.begin());
  for (std::size_t k = 0; k < morph_.paths(); ++k) state_[k] = inside(k, s[k]);
  morph_.shape(s, shape_);
  const double* shift = s + morph_.paths();
  rotation_ = rotation(shift + 3);
  const double d[3] = {x[0] - centre_[0] - shift[0], x[1] - centre_[1] - shift[1],
                       x[2] - centre_[2] - shift[2]};
  const std::array<double, 9>& r = rotation_.matrix;
  for (int a = 0; a < 3; ++a) probe_[a] = r[a] * d[0] + r[3 + a] * d[1] + r[6 + a] * d[2];
}

HAPGRID_WITH_AVX2
void HybridEnergy::find_contacts() {
  contact_count_ = 0;
  if (!held_.empty()) return find_held();
  for (std::size_t i = 0; i < reach_.size(); ++i) {
    const double d[3] = {shape_.x[i] - probe_[0], shape_.y[i] - probe_[1], shape_.z[i] - probe_[2]};
    const double squared = dot(d, d);
    if (!(squared < reach_[i] * reach_[i])) continue;
    const double distance = std::sqrt(squared);
    // A probe in an atom's very centre has no direction to push along; x is as good as any.
    const bool apart = distance > 1e-9;
    const double overlap = reach_[i] - distance;
    contacts_[contact_count_++] = {
        i,
        distance,
        overlap,
        parameters_.penalty,
        parameters_.penalty * overlap / std::max(distance, 1e-3),
        {apart ? d[0] / distance : 1, apart ? d[1] / distance : 0, apart ? d[2] / distance : 0}};
  }
}

/// The one contact of a tie: U(d) = F (w - a) with w = √(d² + a²), so U' = F d / w, U'' = F a² /
/// w³.
void HybridEnergy::find_held() {
  double d[3] = {-probe_[0], -probe_[1], -probe_[2]};
  for (const std::size_t i : held_) {
    const double at[3] = {shape_.x[i], shape_.y[i], shape_.z[i]};
    for (int a = 0; a < 3; ++a) d[a] += at[a] / static_cast<double>(held_.size());
  }
  const double distance = std::sqrt(dot(d, d)), width = parameters_.hold_width;
  const double wide = std::hypot(distance, width), bend = -parameters_.hold_force / wide;
  Contact& tie = contacts_[contact_count_++];
  tie = {0, distance, bend * distance, -bend * square(width / wide), bend, {1, 0, 0}};
  if (distance > 1e-9)
    for (int a = 0; a < 3; ++a) tie.normal[a] = d[a] / distance;
}

double HybridEnergy::tie_energy() const {
  const double width = parameters_.hold_width;
  return parameters_.hold_force * (std::hypot(contacts_[0].distance, width) - width);
}

double HybridEnergy::shape_energy(const double* t) const {
  double sum = 0;
  for (std::size_t k = 0; k < profiles_.size(); ++k) sum += profiles_[k].at(inside(k, t[k])).energy;
  return sum;
}

double HybridEnergy::between_branches() const {
  if (branches_ == 0) return 0;
  double sum = 0, squares = 0;  // Σ_{k<l} a_k a_l of a_k = (L_k t_k)²
  for (std::size_t k = 0; k < morph_.paths(); ++k) {
    const double a = square(morph_.length(k) * state_[k]);
    sum += a * squares;
    squares += a;
  }
  return branches_ * sum;
}

void HybridEnergy::leave_branches(double* gradient, double* hessian) const {
  if (branches_ == 0) return;
  const std::size_t paths = morph_.paths();
  for (std::size_t k = 0; k < paths; ++k)
    for (std::size_t l = 0; l < paths; ++l) {
      if (l == k) continue;
      const double both = 2 * branches_ * square(morph_.length(k) * morph_.length(l));
      gradient[k] += both * state_[k] * square(state_[l]);
      hessian[k * variables_ + k] += both * square(state_[l]);
      hessian[k * variables_ + l] += 2 * both * state_[k] * state_[l];
    }
}

double HybridEnergy::value(const double* s, const double* x) {
  place(s, x);
  find_contacts();
  const std::size_t paths = morph_.paths();
  double hand = held_.empty() ? 0 : 2 * tie_energy();  // twice, in units of unit_
  for (std::size_t c = 0; c < contact_count_ && held_.empty(); ++c)
    hand += square(contacts_[c].push);
  double stretch = 0;
  for (std::size_t k = 0; k < paths; ++k) stretch += square(inside(k, s[k]));
  const double* shift = s + paths;
  const double* turn = shift + 3;
  return shape_energy(s) + between_branches() +
         0.5 * (unit_ * hand +
                parameters_.shift_stiffness *
                    (square(shift[0]) + square(shift[1]) + square(shift[2])) +
                parameters_.rotation_stiffness *
                    (square(turn[0]) + square(turn[1]) + square(turn[2])) +
                parameters_.morph_stiffness * stretch);
}

HAPGRID_WITH_AVX2
void HybridEnergy::derivatives(double* gradient, double* hessian, bool anew) {
  const std::size_t n = variables_, paths = morph_.paths();
  std::fill_n(hessian, n * n, 0.0);
  for (std::size_t k = 0; k < paths; ++k) {
    const Profile::Value e = profiles_[k].at(state_[k]);
    gradient[k] = e.slope + parameters_.morph_stiffness * state_[k];
    hessian[k * n + k] = e.curvature + parameters_.morph_stiffness;
  }
  for (std::size_t i = paths; i < n; ++i) {
    const double stiffness =
        i < paths + 3 ? parameters_.shift_stiffness : parameters_.rotation_stiffness;
    gradient[i] = stiffness * state_[i];
    hessian[i * n + i] = stiffness;
  }
  leave_branches(gradient, hessian);
  if (anew) bending_.fill(0);
  if (contact_count_ == 0) return;
  morph_.differentiate(shape_);
  for (std::size_t c = 0; c < contact_count_; ++c) add_contact(contacts_[c], gradient, hessian);
  if (anew) {
    std::size_t pulls = 0;
    for (std::size_t c = 0; c < contact_count_; ++c) {
      const Contact& contact = contacts_[c];
      const auto [first, count] = places(contact);
      const double push = unit_ * contact.push / static_cast<double>(count);
      for (std::size_t i = 0; i < count; ++i)
        pulls_[pulls++] = {
            first[i],
            {push * contact.normal[0], push * contact.normal[1], push * contact.normal[2]}};
    }
    morph_.curvature(shape_, pulls_.data(), pulls, bending_.data());
  }
  for (std::size_t k = 0; k < paths; ++k)
    for (std::size_t l = 0; l <= k; ++l) hessian[k * n + l] -= bending_[k * paths + l];
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) hessian[j * n + i] = hessian[i * n + j];
}

/// Adds the derivatives of one contact's energy U(d). All vectors are in the molecule's frame:
/// there the atom a moves with its velocity for t, with the rows of the rotation for the shift, and
/// with φ x a, φ = rate dr, for the rotation; so does the mean of several atoms, which is linear in
/// them. With n the unit vector from the probe and d the distance,
///   ∇U = U' ∇d,   ∇²U = U'' ∇d ∇dᵀ + U' ∇²d,   ∇²d = Gᵀ (1 - n nᵀ) G / d + n · ∂²a.
HAPGRID_WITH_AVX2
void HybridEnergy::add_contact(const Contact& contact, double* gradient, double* hessian) {
  const std::size_t n = variables_, paths = morph_.paths();
  const double* normal = contact.normal;
  const auto [first, count] = places(contact);
  const double share = 1 / static_cast<double>(count);
  double a[3] = {};
  double g[3][kMaxVariables];   // ∂a/∂s
  double along[kMaxVariables];  // ∂d/∂s
  double turning[3][3];         // φ by the rotation's variables
  for (auto& row : g) std::fill_n(row, paths, 0.0);
  for (const std::size_t* place = first; place != first + count; ++place) {
    const double at[3] = {shape_.x[*place], shape_.y[*place], shape_.z[*place]};
    morph_.velocity(shape_, *place, velocity_.data());
    for (int i = 0; i < 3; ++i) {
      a[i] += share * at[i];
      for (std::size_t k = 0; k < paths; ++k) g[i][k] += share * velocity_[3 * k + i];
    }
  }
  for (int j = 0; j < 3; ++j) {
    double* phi = turning[j];
    for (int i = 0; i < 3; ++i) {
      g[i][paths + j] = rotation_.matrix[3 * j + i];
      phi[i] = rotation_.rate[3 * i + j];
    }
    double turned[3];
    cross(phi, a, turned);
    for (int i = 0; i < 3; ++i) g[i][paths + 3 + j] = turned[i];
  }
  for (std::size_t i = 0; i < n; ++i)
    along[i] = g[0][i] * normal[0] + g[1][i] * normal[1] + g[2][i] * normal[2];
  const double push = unit_ * contact.push, bend = contact.bend;
  for (std::size_t i = 0; i < n; ++i) {
    gradient[i] -= push * along[i];
    const double f = (contact.stiffness + bend) * along[i];
    for (std::size_t j = 0; j < n; ++j)
      hessian[i * n + j] +=
          f * along[j] - bend * (g[0][i] * g[0][j] + g[1][i] * g[1][j] + g[2][i] * g[2][j]);
  }
  // n · ∂²a: (n·φ)(a·φ) - (n·a) φ² for two turns, φ · (v x n) for a turn and a t.
  const double na = dot(normal, a);
  for (std::size_t i = 0; i < 3; ++i) {
    const double* p = turning[i];
    const double np = dot(normal, p), ap = dot(a, p);
    double* row = hessian + (paths + 3 + i) * n;
    for (std::size_t j = 0; j <= i; ++j) {
      const double* q = turning[j];
      row[paths + 3 + j] -= push * (0.5 * (np * dot(a, q) + dot(normal, q) * ap) - na * dot(p, q));
    }
    for (std::size_t k = 0; k < paths; ++k) {
      const double v[3] = {g[0][k], g[1][k], g[2][k]};
      double vn[3];
      cross(v, normal, vn);
      row[k] -= push * dot(p, vn);
    }
  }
}

void HybridEnergy::force(const double* s, const double* x, double* f) {
  place(s, x);
  find_contacts();
  f[0] = f[1] = f[2] = 0;
  if (contact_count_ == 0) return;
  double sum[3] = {};
  for (std::size_t c = 0; c < contact_count_; ++c)
    for (int a = 0; a < 3; ++a) sum[a] -= contacts_[c].push * contacts_[c].normal[a];
  const std::array<double, 9>& r = rotation_.matrix;
  for (int a = 0; a < 3; ++a)
    f[a] = unit_ * (r[3 * a] * sum[0] + r[3 * a + 1] * sum[1] + r[3 * a + 2] * sum[2]);
}

void HybridEnergy::placed(const double* s, const Morph::Shape& shape, std::size_t i,
                          const Rotation& rotation, double* a) const {
  const double* shift = s + morph_.paths();
  const std::array<double, 9>& r = rotation.matrix;
  for (int j = 0; j < 3; ++j)
    a[j] = centre_[j] + shift[j] + r[3 * j] * shape.x[i] + r[3 * j + 1] * shape.y[i] +
           r[3 * j + 2] * shape.z[i];
}

template <class Number>
void HybridEnergy::positions(const double* s, Number* out) {
  morph_.shape(s, shape_);
  const Rotation r = rotation(s + morph_.paths() + 3);
  for (std::size_t i = 0; i < morph_.atoms(); ++i) {
    double a[3];
    placed(s, shape_, i, r, a);
    for (int j = 0; j < 3; ++j) out[3 * morph_.tree().order[i] + j] = static_cast<Number>(a[j]);
  }
}
template void HybridEnergy::positions(const double*, float*);
template void HybridEnergy::positions(const double*, double*);

double HybridEnergy::displacement(const double* a, const double* b) {
  morph_.shape(a, shape_);
  morph_.shape(b, other_);
  const Rotation ra = rotation(a + morph_.paths() + 3), rb = rotation(b + morph_.paths() + 3);
  double sum = 0;
  for (std::size_t i = 0; i < morph_.atoms(); ++i) {
    double p[3], q[3];
    placed(a, shape_, i, ra, p);
    placed(b, other_, i, rb, q);
    sum += square(p[0] - q[0]) + square(p[1] - q[1]) + square(p[2] - q[2]);
  }
  return std::sqrt(sum / static_cast<double>(morph_.atoms()));
}

}  // namespace hapgrid::molecule
