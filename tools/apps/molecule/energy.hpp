// The hybrid energy (Sect. 3 of the paper): the molecule's energy and the rules of the interaction
// in one quantity, which the model minimises and whose gradient the hand feels. In kJ/mol,
//
//   H(s, x) = Σ_k E_k(t_k)                                  the molecule's own (profile.hpp)
//           + ½ penalty Σ_i max(0, R_i + probe_radius - |x - a_i|)²     a ball that pushes, or
//           + hold_force (√(|x - h|² + hold_width²) - hold_width)       a tie that pulls
//           + ½ shift_stiffness |shift|² + ½ rotation_stiffness |rotation|²
//           + ½ morph_stiffness Σ_k t_k²
//           + branches Σ_{k<l} (L_k t_k L_l t_l)²                 where bonds break and form
//   a_i     = c + shift + R(rotation) (b_i(t) - c),   c the centre of what the morph aligns
//   h       = the mean of a_i over the atoms that are held
//
// with b_i(t) from the morph and L_k the length of a path. Of paths on which bonds break and form
// two cannot be gone at once: the last term keeps the molecule on one of them, and is 0 there. The
// term before it is a stabiliser and no part of the molecule's energy: it leads back to the
// conformation where the profiles are flat.
//
// A state is t_1 .. t_K (in [0, 1], or in [low, low + 1] where a path goes on behind its saddles),
// shift (3, Å) and rotation (3, a rotation vector in rad).
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "tools/apps/molecule/morph.hpp"
#include "tools/apps/molecule/profile.hpp"

namespace hapgrid::molecule {

inline constexpr std::size_t kMaxVariables = kMaxPaths + 6;

struct EnergyParameters {
  double probe_radius = 1.2;        // Å
  double penalty = 100;             // kJ/(mol Å²)
  double shift_stiffness = 20;      // kJ/(mol Å²)
  double rotation_stiffness = 100;  // kJ/(mol rad²)
  double morph_stiffness = 5;       // kJ/mol
  /// Atoms from 0 whose centre the hand holds, instead of pushing with the ball; none: the ball.
  std::vector<int> hold = {};
  double hold_force = 40;   // kJ/(mol Å): the tie never pulls stronger
  double hold_width = 0.5;  // Å; near the atom the tie is a spring of hold_force / hold_width
};

/// An object keeps what it computed last, so only one thread may use it. Real-time safe after
/// construction.
class HybridEnergy {
 public:
  /// @throw std::runtime_error as Morph does.
  HybridEnergy(const Molecule& molecule, const EnergyParameters& parameters);

  std::size_t variables() const { return variables_; }
  const Morph& morph() const { return morph_; }
  const EnergyParameters& parameters() const { return parameters_; }
  /// The least t_k; the largest is one more.
  double low(std::size_t k) const { return morph_.low(k); }
  /// Whether t_k has no ends, as Morph has it, and the t_k that counts.
  bool closes(std::size_t k) const { return morph_.closes(k); }
  double inside(std::size_t k, double t) const { return morph_.inside(k, t); }
  /// How far a unit of a variable moves the atoms, Å RMS: the minimiser's scale.
  double scale(std::size_t variable) const { return scale_[variable]; }

  /// H(s, x), kJ/mol.
  double value(const double* s, const double* x);
  /// Whether the hand acts on an atom in the last value(): the probe touches one, or one is held.
  bool touches() const { return contact_count_ > 0; }
  /// At the s and x of the last value(): the gradient ∂H/∂s (n), and the Hessian (n x n, symmetric)
  /// without the second derivatives of the rotation's parametrisation. The morph's second
  /// derivatives change slowly: without `anew` their part is that of the last call.
  void derivatives(double* gradient, double* hessian, bool anew);

  /// -∂H/∂x, kJ/(mol Å).
  void force(const double* s, const double* x, double* f);
  /// Σ_k E_k(t_k), kJ/mol: the molecule's energy alone.
  double shape_energy(const double* t) const;

  /// Positions in state s, Å: 3 numbers an atom, by the atom's index in the molecule.
  template <class Number>
  void positions(const double* s, Number* out);
  /// RMS displacement of the atoms between two states, Å.
  double displacement(const double* a, const double* b);

 private:
  /// What the hand does to an atom, or to the centre of those that are held. U is its energy.
  struct Contact {
    std::size_t place;  // in the tree's order; of those that are held, held_ has it
    double distance;    // d
    double push;        // -U'(d) / unit_; of the ball the overlap
    double stiffness;   // U''(d)
    double bend;        // -U'(d) / d
    double normal[3];   // from the probe to the atom, in the molecule's frame
  };
  /// R(v) and the matrix J of dR = R [J dv]x, row by row (Gallego and Yezzi 2015).
  struct Rotation {
    std::array<double, 9> matrix, rate;
  };
  static Rotation rotation(const double* vector);

  void place(const double* s, const double* x);
  void find_contacts();
  void find_held();
  /// What keeps the molecule on one path at a time, kJ/mol, and its derivatives.
  double between_branches() const;
  void leave_branches(double* gradient, double* hessian) const;
  /// The tie's energy, kJ/mol.
  double tie_energy() const;
  /// The places in the tree's order at which a contact acts, each with the same share.
  std::pair<const std::size_t*, std::size_t> places(const Contact& contact) const {
    return held_.empty() ? std::pair(&contact.place, std::size_t{1})
                         : std::pair(held_.data(), held_.size());
  }
  void add_contact(const Contact& contact, double* gradient, double* hessian);
  void placed(const double* s, const Morph::Shape& shape, std::size_t i, const Rotation& r,
              double* a) const;

  EnergyParameters parameters_;
  Morph morph_;
  std::size_t variables_;
  std::vector<double> scale_;
  std::vector<Profile> profiles_;
  std::vector<double> reach_;      // R_i + probe_radius by place in the tree's order
  std::vector<std::size_t> held_;  // places in the tree's order; none: the ball
  double branches_ = 0;            // kJ/(mol Å⁴): keeps the molecule on one path at a time
  double unit_;                    // of a contact's push: the penalty, or 1 of a tie
  std::array<double, 3> centre_;

  Morph::Shape shape_, other_;
  Rotation rotation_;
  std::array<double, kMaxVariables> state_;
  std::array<double, 3> probe_;    // in the molecule's frame
  std::vector<Contact> contacts_;  // the first contact_count_ count
  std::size_t contact_count_ = 0;
  std::vector<Morph::Pull> pulls_;                     // of the contacts
  std::vector<double> velocity_;                       // 3 x paths
  std::array<double, kMaxPaths * kMaxPaths> bending_;  // Σ push n · ∂²a/∂t∂t, paths x paths
};

}  // namespace hapgrid::molecule
