#include "libcore/follow/tear_function.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace hapgrid {

namespace {

constexpr double kNothingTears = 2;  // spacings
constexpr double kLeast = 1e-3;      // spacings; the sign that a record or a ghost keeps
// How much an equation of the start value counts beside one of a tear fraction: little, so that it
// decides only where no fraction does. And how often the conjugate gradients step.
constexpr double kStartWeight = 0.02;
constexpr int kSteps = 20;

/// The plane that fits places around a node best, by least squares of n·c = 1.
class Plane {
 public:
  /// @param c in spacings from the node
  void add(const Vec3& c) {
    for (int a = 0; a < 3; ++a) {
      sum_[a] += c[a];
      for (int b = 0; b < 3; ++b) square_[a][b] += c[a] * c[b];
    }
    ++places_;
  }
  bool any() const { return places_ > 0; }
  /// Its distance from the node.
  double distance() const;

 private:
  std::array<Vec3, 3> square_{};
  Vec3 sum_{};
  int places_ = 0;
};

double determinant(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

double Plane::distance() const {
  // One or two places do not make a plane: the ridge then gives the one that is farthest away.
  auto m = square_;
  const double ridge = 1e-6 * (m[0][0] + m[1][1] + m[2][2]);
  for (int a = 0; a < 3; ++a) m[a][a] += ridge;
  const double whole = determinant(m[0], m[1], m[2]);
  Vec3 n;
  for (int a = 0; a < 3; ++a) {
    auto replaced = m;
    replaced[a] = sum_;
    n[a] = determinant(replaced[0], replaced[1], replaced[2]) / whole;
  }
  const double length = std::hypot(n[0], n[1], n[2]);
  return length > 0 ? std::min(1 / length, kNothingTears) : kNothingTears;
}

/// "The sum of weight[k] value[node[k]] is 0", of a link along one, two or three axes.
struct Equation {
  std::array<Node, 8> node;
  std::array<double, 8> weight;
  int size;
};

/// False where a corner of the cell that the link crosses is missing.
bool make_equation(const BranchNodes& branches, RecordIndex r, int q, double t,
                   Equation& equation) {
  const auto d = Direction(q).step();
  std::array<int, 3> axes{};
  int count = 0;
  for (int a = 0; a < 3; ++a)
    if (d[a] != 0) axes[count++] = a;
  equation.size = 1 << count;
  for (int corner = 0; corner < equation.size; ++corner) {
    std::array<int, 3> step{};
    double weight = 1;
    for (int i = 0; i < count; ++i) {
      const bool there = corner >> i & 1;
      if (there) step[axes[i]] = d[axes[i]];
      weight *= there ? t : 1 - t;
    }
    equation.node[corner] =
        corner == 0 ? r : branches.node(r, Direction::of(step[0], step[1], step[2]).q());
    if (equation.node[corner] == BranchNodes::kNoNode) return false;
    equation.weight[corner] = weight;
  }
  return true;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// The normal matrix of the equations and of the start values, times v.
std::vector<double> normal(const std::vector<Equation>& equations, const std::vector<double>& v,
                           double start_weight) {
  std::vector<double> product(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) product[i] = start_weight * v[i];
  for (const Equation& e : equations) {
    double sum = 0;
    for (int k = 0; k < e.size; ++k) sum += e.weight[k] * v[e.node[k]];
    for (int k = 0; k < e.size; ++k) product[e.node[k]] += e.weight[k] * sum;
  }
  return product;
}

/// Moves `value` towards the equations by conjugate gradients.
void solve(const std::vector<Equation>& equations, std::vector<double>& value) {
  std::vector<double> rest = normal(equations, value, 0);
  for (double& x : rest) x = -x;
  std::vector<double> way = rest;
  double size = dot(rest, rest);
  for (int step = 0; step < kSteps && size > 0; ++step) {
    const std::vector<double> image = normal(equations, way, kStartWeight);
    const double length = size / dot(way, image);
    for (std::size_t i = 0; i < value.size(); ++i) {
      value[i] += length * way[i];
      rest[i] -= length * image[i];
    }
    const double next = dot(rest, rest);
    for (std::size_t i = 0; i < way.size(); ++i) way[i] = rest[i] + next / size * way[i];
    size = next;
  }
}

}  // namespace

std::vector<float> tear_function(const Grid& grid, const BranchNodes& branches) {
  std::vector<Equation> equations;
  // Most records are nowhere near a tear: only the nodes of equations are numbered, in the order in
  // which they come.
  const std::size_t nodes = std::size_t{grid.records()} + branches.ghosts();
  constexpr Node kNone = ~Node{0};
  std::vector<Node> number(nodes, kNone), numbered;
  std::vector<Plane> planes;
  const auto number_of = [&](Node node) {
    if (number[node] == kNone) {
      number[node] = static_cast<Node>(numbered.size());
      numbered.push_back(node);
      planes.emplace_back();
    }
    return number[node];
  };
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (DirectionMask left = branches.one_way(r); left != 0; left &= left - 1) {
      const int q = std::countr_zero(left);
      const double t = tear_fraction(grid, r, q);
      const auto d = Direction(q).step();
      planes[number_of(r)].add({t * d[0], t * d[1], t * d[2]});
      planes[number_of(branches.node(r, q))].add({(t - 1) * d[0], (t - 1) * d[1], (t - 1) * d[2]});
      Equation equation{};
      if (!make_equation(branches, r, q, t, equation)) continue;
      for (int k = 0; k < equation.size; ++k) equation.node[k] = number_of(equation.node[k]);
      equations.push_back(equation);
    }
  std::vector<double> value(numbered.size(), kNothingTears);
  for (std::size_t i = 0; i < value.size(); ++i)
    if (planes[i].any())
      value[i] = branches.is_ghost(numbered[i]) ? -planes[i].distance() : planes[i].distance();
  solve(equations, value);
  std::vector<float> result(nodes, static_cast<float>(kNothingTears));
  for (std::size_t i = 0; i < value.size(); ++i)
    result[numbered[i]] = static_cast<float>(
        branches.is_ghost(numbered[i]) ? std::min(value[i], -kLeast) : std::max(value[i], kLeast));
  return result;
}

}  // namespace hapgrid
