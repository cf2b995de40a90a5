// The shape of the molecule for given morphing parameters t, and how it changes with them.
//
// The paths' changes of the internal coordinates (tree.hpp) are added up:
// q(t) = q(0) + Σ_k (spline_k(t_k) - q(0)), where spline_k is the natural cubic spline through the
// nodes of path k. Along one path alone the nodes are reproduced exactly. The shape is rebuilt from
// q in a local frame and aligned to the conformation: the centres of mass coincide, and the
// rotation makes the mass-weighted sum of squared distances least. So a change of shape is no
// change of place. Where the molecule says which of its atoms are fixed, these alone are aligned:
// they stay in their place, and all others move against them.
//
// Where bonds break and form there is no tree of bonds. Then the positions themselves are what
// splines interpolate, of nodes of which each is aligned to the one before it.
//
// The haptic loop needs a shape in microseconds. So the coefficients of all coordinates lie side by
// side, all sines are computed in one loop that vectorises, the rebuilding only carries frames from
// parents to children, and the alignment takes the largest root of a quartic (Theobald 2005).
//
// First derivatives are carried forward for all t_k at once: the frames' angular velocities and the
// atoms' velocities are passed down the tree, since the minimiser needs the gradient of the
// distance to each atom that the probe touches. Of the second derivatives it needs only one sum,
// weighted by the contacts' forces: the forces are passed up the tree (adjoint).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "tools/apps/molecule/elementary.hpp"
#include "tools/apps/molecule/input.hpp"
#include "tools/apps/molecule/lanes.hpp"
#include "tools/apps/molecule/tree.hpp"

namespace hapgrid::molecule {

/// The most transition states; arrays of fixed size have room for so many.
inline constexpr std::size_t kMaxPaths = 16;

class Morph {
 public:
  /// Everything about one t, written by shape() and differentiate(). It is made once and used
  /// again, so that neither of them allocates; what it holds already is not computed again.
  class Shape {
   public:
    /// Atoms by place in the tree's order; positions in Å in the frame of the conformation, the
    /// origin the centre of mass of what is aligned.
    std::vector<double> x, y, z;

   private:
    friend class Morph;
    std::vector<double> t;
    int derivatives =
        -1;  // 1: the first derivatives are those of t; 0: only the shape is; -1: nothing
    std::vector<double> q;              // length, deflection, torsion: 3 x stride_
    std::vector<double> sine, cosine;   // of deflection and torsion: 2 x stride_
    std::vector<double> frame;          // 9 an atom: axes x, y, z in the local frame
    std::vector<double> local;          // 3 an atom: position in the local frame
    std::array<double, 9> rotation;     // local to the conformation's frame, row by row
    std::array<double, 9> inverse;      // of tr(A) 1 - A, A = Σ m a cᵀ
    std::vector<double> rate;           // dq/dt: 3 x stride_ x width_
    std::vector<double> turning;        // angular velocities, local: 3 x width_ an atom
    std::vector<double> moving;         // velocities, local: 3 x width_ an atom
    std::vector<double> centre_moving;  // of the centre of mass, local: 3 x width_
    std::vector<double> aligning;       // angular velocity of the alignment: 3 x width_
    std::array<double, 9> overlap;      // A, row by row
    std::vector<double> overlap_rate;   // Σ m (R v) cᵀ: 9 x width_
    // For curvature():
    std::vector<double> pull;    // forces on the atoms, local; then on all that is behind them
    std::vector<double> twist;   // torques on the frames, local
    std::vector<double> weight;  // of d²q/dt_k²: 3 x stride_
  };

  /// @throw std::runtime_error when the molecule has torsions that are not defined, more than
  /// kMaxPaths paths, or a transition state that is the conformation.
  explicit Morph(const Molecule& molecule);

  std::size_t atoms() const { return tree_.size(); }
  std::size_t paths() const { return paths_.size(); }
  const Tree& tree() const { return tree_; }
  /// The centre of mass of what is aligned, in the conformation as its text has it, Å.
  const Eigen::Vector3d& centre() const { return centre_; }
  /// The least t_k; the largest is one more. 0 unless the conformation is inside the path.
  double low(std::size_t k) const { return paths_[k].low; }
  /// Whether t_k has no ends: t_k and t_k + 1 are one shape in one place.
  bool closes(std::size_t k) const { return paths_[k].closes; }
  /// The t_k that counts: the nearest in the range, or where the path closes the same one there.
  double inside(std::size_t k, double t) const {
    return closes(k) ? wrapped(t, low(k)) : clamped(t, low(k));
  }
  /// RMS displacement of the atoms between t = 0 and t_k = 1, Å: above 0. Of a path that goes on
  /// behind its saddles, and may lead round, the sum from node to node.
  double length(std::size_t k) const { return paths_[k].length; }
  /// RMS distance of the conformation's atoms from that centre, Å.
  double gyration() const { return gyration_; }

  Shape make_shape() const;
  /// The shape for t, which has paths() numbers; inside() says which one counts, and one that is
  /// not a number counts as 0. Real-time safe.
  void shape(const double* t, Shape& shape) const;
  /// Computes what velocity() needs, for the t of the last shape(). Real-time safe.
  void differentiate(Shape& shape) const;
  /// ∂(position)/∂t_k of the atom at a place of the tree's order, Å: v[3 k] is the first of three.
  void velocity(const Shape& shape, std::size_t place, double* v) const;
  /// A force on the atom at a place of the tree's order.
  struct Pull {
    std::size_t place;
    double force[3];
  };
  /// Σ force · ∂²(position)/∂t_k∂t_l over `count` pulls, into c[paths() k + l]; call it after
  /// differentiate(). Real-time safe.
  void curvature(Shape& shape, const Pull* pulls, std::size_t count, double* c) const;

 private:
  struct Spline {
    std::size_t segments;
    std::vector<double> coefficients;  // [segment][power 0..3][3 x stride_], less q(0)
    double length;
    double low;    // the least t
    double first;  // segments before the conformation
    bool closes;

    /// The segment in which t lies, and the place u in it, from 0 to 1.
    struct Piece {
      const double* coefficients;  // [power][coordinate]
      double u;
    };
    Piece piece(double t, std::size_t coordinates) const {
      const double at = std::max(0.0, t * static_cast<double>(segments) + first);
      const std::size_t segment = std::min(static_cast<std::size_t>(at), segments - 1);
      return {&coefficients[segment * 4 * coordinates], at - static_cast<double>(segment)};
    }
  };

  void weigh(const Molecule& molecule);
  void measure(const Molecule& molecule, std::size_t k);
  bool meets(std::size_t k) const;
  Spline spline(const Path& path, const Internal& conformation, const std::string& where) const;
  Spline through(const Path& path, const std::vector<std::vector<double>>& nodes,
                 bool closes) const;
  void find_splines(const Molecule& molecule);
  void find_splines_in_space(const Molecule& molecule);
  void interpolate(Shape& shape) const;
  void build(Shape& shape) const;
  void align(Shape& shape) const;
  void differentiate_tree(Shape& shape) const;
  void spread_pulls(Shape& shape, const double* force, const double* u) const;
  void sweep(Shape& shape, double* sum) const;
  /// First moments of the atoms' velocities, for four parameters at once.
  struct Moments {
    Four sum[9], centre[3];
  };
  Moments moments(const std::vector<double>& velocities, std::size_t stride, std::size_t at) const;
  static void turn_back(const Shape& shape, const Four* p, double* turn, std::size_t stride);

  bool in_space_;  // q is x, y and z of the atoms, from centre_
  Tree tree_;
  std::size_t first_;   // the first atom that moves in the local frame: the root of a tree does not
  std::size_t stride_;  // atoms, rounded up to a multiple of four
  std::size_t width_;   // paths, rounded up to a multiple of four
  std::vector<double> weight_;  // in the alignment: the mass, or 0 of an atom that is not fixed
  double total_weight_ = 0;
  Eigen::Vector3d centre_;
  double gyration_ = 0;
  std::vector<double> q0_;                              // as Shape::q
  std::array<double, 9> root_frame_;                    // axes of the conformation's
  std::vector<double> weight_x_, weight_y_, weight_z_;  // weight times position of the conformation
  std::vector<double> x0_, y0_, z0_;                    // the conformation
  double square_ = 0;                                   // Σ m |c|²
  std::vector<Spline> paths_;
};

}  // namespace hapgrid::molecule
