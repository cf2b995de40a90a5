// The finite elements of this example: a block of soft tissue stands on a rigid ground, and a rigid
// ball is pushed into it. Nothing here knows of hapgrid.
//
// Problem. For each position of the ball we need a state of mechanical equilibrium, with the same
// bits whenever it is computed from the same state, thousands of times a minute. A body that is
// moved slowly stays in a minimum of its total energy, so we look for the minimum that lies
// downhill of the last state. Alternatives: dynamics with damping (thousands of small steps for one
// answer), a linear model (one matrix, but the block grows when it is turned), explicit relaxation
// (it leaves too large a residual). Chosen: Newton's method on the non-linear energy with an exact
// sparse factorisation (Eigen's SimplicialLDLT). The mesh never changes, so the ordering and the
// pattern are found once.
//
// Material. St. Venant-Kirchhoff on linear tetrahedra: with the displacement's gradient H, F = I +
// H, E = (F^T F - I) / 2, the energy per volume is lambda/2 tr(E)^2 + mu tr(E^2). This is the
// linear elastic material, made indifferent to rotations. It softens under strong compression and
// gives way below a stretch of 1/sqrt(3) along one axis; relax() therefore refuses inverted
// elements.
//
// Mesh. The block consists of nx x ny x nz equal bricks. Each is cut into the six tetrahedra that
// lead from one corner to the opposite one (Kuhn's), mirrored in x and y from brick to brick. So
// neighbours share their faces' diagonals, and with even nx and ny the mesh has the block's own
// mirror symmetries.
//
// Contact. There is no friction. A pressure acts on the free surface (top and sides) and depends on
// the gap between a point of the surface and the ball; its potential per undeformed area is
// integrated with three points a triangle. The pressure is a C1 function of the gap. With adhesion
// it also pulls within a short range. Then the surface jumps to the ball and tears off later than
// it jumped, so the states depend on the way.
//
// Units: mm, N, N/mm^2 (1 kPa = 1e-3 N/mm^2), energies in N mm.
#pragma once

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
  double contact_smoothing = 0.5;    ///< depth over which the pressure grows to that, mm
  double adhesion = 4e-3;            ///< the strongest pull, N/mm^2
  double adhesion_range = 2;         ///< gap at which the pull ends, mm
  double residual = 1e-8;            ///< largest nodal force out of balance, N
  int max_iterations = 60;           ///< steps of Newton's method for one equilibrium
};

/// Whether the block of a pair of nodes belongs to the lower triangle, and neither is fixed.
inline bool counts(int a, int b) { return b >= 0 && a >= b; }

class Block {
 public:
  explicit Block(const Options& options);

  /// The number of free nodes. A displacement has 3 numbers for each, x y z, in mm. Nodes ascend by
  /// layer from the ground up, in a layer with x fastest. The ground's layer is fixed and left out.
  std::size_t nodes() const { return rest_.size() - first_free_; }
  std::size_t unknowns() const { return 3 * nodes(); }
  /// Where a free node lies without load, mm.
  const Vec3& rest(std::size_t node) const { return rest_[first_free_ + node]; }
  /// The free nodes on the free surface (top and sides), ascending.
  const std::vector<std::size_t>& surface() const { return surface_; }

  /// Whether a ball at `centre` neither touches nor attracts the unloaded block.
  bool is_clear(const Vec3& centre) const;

  /// The energy, N mm, of displacement u with the ball at `centre`, and its gradient by u, N. Where
  /// an element is inverted the energy is infinite and the gradient is not set.
  double energy(const Vector& u, const Vec3& centre, Vector& gradient) const;
  /// The second derivative of the energy by u, N/mm; its pattern is always the same.
  void tangent(const Vector& u, const Vec3& centre, Matrix& k) const;
  /// The force on the ball, N: minus the gradient of the energy by `centre`.
  Vec3 force(const Vector& u, const Vec3& centre) const;

  /// Moves u into the equilibrium next to it.
  /// @throw std::runtime_error, one line, when Newton's method does not converge, or would only do
  /// so through an inverted element.
  void relax(Vector& u, const Vec3& centre);
  /// Takes the ball from `from`, where u is in equilibrium, straight to `to`, in equal substeps no
  /// longer than `substep`, mm. The result depends on the arguments alone.
  /// @throw std::runtime_error as relax() does.
  void follow(Vector& u, const Vec3& from, const Vec3& to, double substep);

 private:
  struct Tetrahedron {
    std::array<int, 4> node;    ///< free nodes; negative on the ground
    std::array<Vec3, 4> slope;  ///< gradients of the shape functions, 1/mm
    double volume;
  };
  struct Triangle {
    std::array<int, 3> node;  ///< free nodes; negative on the ground
    std::array<Vec3, 3> rest;
    double area;
  };
  struct Contact {
    double energy;    ///< per area
    double pressure;  ///< minus its derivative by the gap
    double slope;     ///< the second derivative
  };

  // Their numbers, by the grid of nodes: of all, and of those that are free (-1: it is held).
  int node_at(int i, int j, int k) const;
  int free_node(int i, int j, int k) const;
  void build_tetrahedra();
  void build_triangles();
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
};

}  // namespace soft_tissue
