// A block of soft tissue on a rigid ground, and a rigid ball that is pushed into it: the finite
// elements of this example, without anything of hapgrid.
//
// Problem. A position of the ball has to give a state of mechanical equilibrium, the same bits
// whenever it is computed from the same state, and thousands of times a minute. A minimum of the
// total energy is looked for, starting at the state before: that is what a body does that is moved
// slowly. Alternatives: dynamics with damping (thousands of small steps for one answer), a linear
// model (one matrix, but a block that grows when it is turned), explicit relaxation (no tight
// residual). Chosen: Newton's method on the non-linear energy with an exact sparse factorisation
// (Eigen's SimplicialLDLT), whose ordering and pattern are found once, as the mesh never changes.
//
// Material. St. Venant-Kirchhoff on linear tetrahedra: with the displacement's gradient H, F = I +
// H, E = (F^T F - I) / 2, the energy per volume is lambda/2 tr(E)^2 + mu tr(E^2). It is the linear
// elastic material that turns freely; it softens under strong compression (below a stretch of
// 1/sqrt(3) along one axis it gives way), which is why convert() refuses an inverted element.
//
// Mesh. nx x ny x nz equal bricks, each cut into the six tetrahedra that lead from one corner to
// the opposite one (Kuhn's), mirrored in x and y from brick to brick. So neighbours share their
// faces' diagonals, and with even nx and ny the mesh has the block's own mirror symmetries.
//
// Contact. Without friction, by a pressure on the free surface (top and sides) that depends on the
// gap between a point of the surface and the ball: its potential per undeformed area is integrated
// with three points a triangle. The pressure is a C1 function of the gap. With adhesion it also
// pulls within a short range, and then the surface jumps to the ball and tears off later: the
// states come to depend on the way.
//
// Units: mm, N, N/mm^2 (1 kPa = 1e-3 N/mm^2), energies in N mm.
#pragma once

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace soft_tissue {

using Vec3 = Eigen::Vector3d;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double>;  // the lower triangle alone

struct Options {
  std::array<double, 3> size{72, 72, 18};  ///< of the block, mm; it stands on z = 0, its axis is z
  std::array<int, 3> elements{12, 12, 3};  ///< bricks along each axis; even along x and y
  double young_modulus = 6e-3;             ///< N/mm^2
  double poisson_ratio = 0.4;
  double probe_radius = 15;          ///< of the ball, mm
  double contact_stiffness = 20e-3;  ///< pressure per depth, N/mm^3
  double contact_smoothing = 0.5;    ///< depth over which it grows to that, mm
  double adhesion = 4e-3;            ///< the strongest pull, N/mm^2
  double adhesion_range = 2;         ///< gap at which it ends, mm
  double residual = 1e-8;            ///< largest nodal force out of balance, N
  int max_iterations = 60;           ///< of one equilibrium
};

class Block {
 public:
  explicit Block(const Options& options);

  /// Free nodes; a displacement is 3 numbers a node, x y z, in mm. Nodes ascend by layer from the
  /// ground up, in a layer x fastest. The ground's layer is fixed and has no numbers.
  std::size_t nodes() const { return rest_.size() - first_free_; }
  std::size_t unknowns() const { return 3 * nodes(); }
  /// Where a free node is without load.
  const Vec3& rest(std::size_t node) const { return rest_[first_free_ + node]; }
  /// The free nodes on the free surface (top and sides), ascending.
  const std::vector<std::size_t>& surface() const { return surface_; }

  /// Whether a ball at `centre` neither touches nor attracts the unloaded block.
  bool is_clear(const Vec3& centre) const;

  /// Energy of displacement u with the ball at `centre`, and its gradient by u; infinite, and no
  /// gradient, where an element is inverted.
  double energy(const Vector& u, const Vec3& centre, Vector& gradient) const;
  /// The second derivative by u; the pattern is always the same.
  void tangent(const Vector& u, const Vec3& centre, Matrix& k) const;
  /// The force on the ball, N: minus the gradient of the energy by `centre`.
  Vec3 force(const Vector& u, const Vec3& centre) const;

  /// Moves u into the equilibrium next to it. @throw std::runtime_error, one line, when there is
  /// none: Newton's method does not converge, or only through an inverted element.
  void relax(Vector& u, const Vec3& centre);
  /// Takes the ball from `from`, where u is in equilibrium, straight to `to`, in equal substeps no
  /// longer than `substep`, mm. Depends on its arguments alone. @throw as relax() does.
  void follow(Vector& u, const Vec3& from, const Vec3& to, double substep);

  /// How often relax() has factorised a matrix, since the start.
  std::size_t factorisations() const { return factorisations_; }

 private:
  struct Tetrahedron {
    std::array<int, 4> node;    ///< free node, or negative on the ground
    std::array<Vec3, 4> slope;  ///< gradients of the shape functions, 1/mm
    double volume;
    /// Where the 3 x 3 block of nodes (a, b) starts in k's values, column by column, for the
    /// pairs with node a >= node b; -1 where one is fixed or the other triangle has it.
    std::array<std::array<std::array<int, 3>, 4>, 4> slot;
  };
  struct Triangle {
    std::array<int, 3> node;  ///< all free, or negative on the ground
    std::array<Vec3, 3> rest;
    double area;
    std::array<std::array<std::array<int, 3>, 3>, 3> slot;
  };
  struct Contact {
    double energy;    ///< per area
    double pressure;  ///< minus its derivative by the gap
    double slope;     ///< the second derivative
  };

  int free_node(int i, int j, int k) const;
  void build_tetrahedra();
  void build_triangles();
  void build_pattern();
  std::array<int, 3> find_slots(int a, int b) const;
  Contact contact(double gap) const;
  template <class F>
  void for_contacts(const Vector& u, const Vec3& centre, F&& f) const;
  bool factorise(const Matrix& k, double shift);
  bool predict(Vector& u, const Vec3& centre, const Vec3& d);
  void relax(Vector& u, const Vec3& centre, bool keep);

  Options options_;
  double lambda_, mu_;
  std::vector<Vec3> rest_;  // all nodes
  std::size_t first_free_ = 0;
  std::vector<std::size_t> surface_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<Triangle> triangles_;
  Matrix pattern_;
  double typical_stiffness_ = 0;  // the mean of the unloaded matrix's diagonal, N/mm
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower> solver_;
  std::size_t factorisations_ = 0;
};

}  // namespace soft_tissue
