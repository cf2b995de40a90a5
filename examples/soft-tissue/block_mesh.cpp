// The block's mesh: the tetrahedra, and the triangles of the free surface.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "examples/soft-tissue/block.hpp"

namespace soft_tissue {

using Matrix3 = Eigen::Matrix3d;

Block::Block(const Options& options) : options_(options) {
  const double e = options_.young_modulus;
  const double v = options_.poisson_ratio;
  lambda_ = e * v / ((1 + v) * (1 - 2 * v));
  mu_ = e / (2 * (1 + v));
  const auto [nx, ny, nz] = options_.elements;
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) {
        // The block's axis is x = y = 0. In this form mirrored nodes have coordinates of the same
        // size to the last bit.
        rest_.emplace_back(options_.size[0] * (2 * i - nx) / (2 * nx),
                           options_.size[1] * (2 * j - ny) / (2 * ny), options_.size[2] * k / nz);
      }
  first_free_ = static_cast<std::size_t>(node_at(0, 0, 1));
  build_tetrahedra();
  build_triangles();
  const auto n = static_cast<Eigen::Index>(unknowns());
  std::vector<Eigen::Triplet<double>> entries;
  for (const Tetrahedron& t : tetrahedra_)
    for (const int a : t.node)
      for (const int b : t.node)
        if (counts(a, b))
          for (int c = 0; c < 3; ++c)
            for (int r = a == b ? c : 0; r < 3; ++r)
              entries.emplace_back(3 * a + r, 3 * b + c, 0.0);
  pattern_.resize(n, n);
  pattern_.setFromTriplets(entries.begin(), entries.end());
  solver_.analyzePattern(pattern_);
  Matrix k;
  tangent(Vector::Zero(n), Vec3(0, 0, std::numeric_limits<double>::infinity()), k);
  typical_stiffness_ = Vector(k.diagonal()).mean();
}

int Block::node_at(int i, int j, int k) const {
  const auto [nx, ny, nz] = options_.elements;
  return i + (nx + 1) * (j + (ny + 1) * k);
}

int Block::free_node(int i, int j, int k) const { return k == 0 ? -1 : node_at(i, j, k - 1); }

void Block::build_tetrahedra() {
  const auto [nx, ny, nz] = options_.elements;
  constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (const auto& order : kOrders) {
          // The tetrahedron's nodes lead from a corner to the opposite one, an axis at a time. The
          // corner alternates from brick to brick.
          int at[3] = {i + i % 2, j + j % 2, k};
          const int step[3] = {i % 2 ? -1 : 1, j % 2 ? -1 : 1, 1};
          Tetrahedron t{};
          Vec3 x[4];
          for (int a = 0; a < 4; ++a) {
            if (a > 0) at[order[a - 1]] += step[order[a - 1]];
            t.node[a] = free_node(at[0], at[1], at[2]);
            x[a] = rest_[static_cast<std::size_t>(node_at(at[0], at[1], at[2]))];
          }
          Matrix3 edges;
          edges << x[1] - x[0], x[2] - x[0], x[3] - x[0];
          // The gradients of shape functions 1 to 3 are the rows of the inverse.
          const Matrix3 inverse = edges.inverse();
          for (int a = 1; a < 4; ++a) t.slope[a] = inverse.row(a - 1).transpose();
          t.slope[0] = -(t.slope[1] + t.slope[2] + t.slope[3]);
          t.volume = std::abs(edges.determinant()) / 6;
          tetrahedra_.push_back(t);
        }
}

void Block::build_triangles() {
  const int nx = options_.elements[0], ny = options_.elements[1], nz = options_.elements[2];
  // Adds a brick's face, which two axes span from a corner. It is cut along the same diagonal as
  // the tetrahedra.
  const auto add_face = [&](std::array<int, 3> corner, int first, int second, int step_first,
                            int step_second) {
    for (const bool swap : {false, true}) {
      std::array<std::array<int, 3>, 3> at{corner, corner, corner};
      at[1][swap ? second : first] += swap ? step_second : step_first;
      at[2][first] += step_first;
      at[2][second] += step_second;
      Triangle t{};
      for (int a = 0; a < 3; ++a) {
        const auto [i, j, k] = at[a];
        t.node[a] = free_node(i, j, k);
        t.rest[a] = rest_[static_cast<std::size_t>(node_at(i, j, k))];
      }
      t.area = (t.rest[1] - t.rest[0]).cross(t.rest[2] - t.rest[0]).norm() / 2;
      triangles_.push_back(t);
    }
  };
  const auto start = [](int i) { return i + i % 2; };
  const auto step = [](int i) { return i % 2 ? -1 : 1; };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) add_face({start(i), start(j), nz}, 0, 1, step(i), step(j));
  for (int k = 0; k < nz; ++k)
    for (const bool far : {false, true}) {
      for (int j = 0; j < ny; ++j) add_face({far ? nx : 0, start(j), k}, 1, 2, step(j), 1);
      for (int i = 0; i < nx; ++i) add_face({start(i), far ? ny : 0, k}, 0, 2, step(i), 1);
    }
  for (std::size_t node = 0; node < nodes(); ++node) {
    bool is_on_surface = false;
    for (const Triangle& t : triangles_)
      is_on_surface |=
          std::find(t.node.begin(), t.node.end(), static_cast<int>(node)) != t.node.end();
    if (is_on_surface) surface_.push_back(node);
  }
}

}  // namespace soft_tissue
