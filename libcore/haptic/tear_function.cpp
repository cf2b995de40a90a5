#include "libcore/haptic/tear_function.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "libcore/base/parallel.hpp"

namespace hapgrid {

namespace {

constexpr double kFarthest = 2;  // spacings
constexpr double kLeast = 1e-3;  // spacings; the sign that a record or a ghost keeps
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
  }
  /// Its distance from the node.
  double distance() const;

 private:
  std::array<Vec3, 3> square_{};
  Vec3 sum_{};
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
  return length > 0 ? std::min(1 / length, kFarthest) : kFarthest;
}

/// What the tear fraction t of a one-way link says. Its nodes are the corners that the cell which
/// it crosses has along the link's one, two or three axes: the record first, the ghost last. They
/// make the equation "the sum of weight[k] value[node[k]] is 0", if none is missing.
struct TornLink {
  double t;
  std::size_t first;  // of its nodes in TornLinks::node
  std::uint8_t q;
  std::uint8_t size;  // so many nodes
  bool is_equation;
};

/// Many of them.
struct TornLinks {
  std::vector<TornLink> items;
  std::vector<Node> node;

  void add(TornLinks&& later) {
    for (TornLink& link : later.items) link.first += node.size();
    items.insert(items.end(), later.items.begin(), later.items.end());
    node.insert(node.end(), later.node.begin(), later.node.end());
  }
  void add(const Sheets& sheets, RecordIndex r, int q, double t);
};

void TornLinks::add(const Sheets& sheets, RecordIndex r, int q, double t) {
  const auto d = Direction(q).step();
  std::array<int, 3> axes{};
  int count = 0;
  for (int a = 0; a < 3; ++a)
    if (d[a] != 0) axes[count++] = a;
  TornLink link{t, node.size(), static_cast<std::uint8_t>(q), static_cast<std::uint8_t>(1 << count),
                true};
  node.push_back(r);
  for (int corner = 1; corner < link.size && link.is_equation; ++corner) {
    std::array<int, 3> step{};
    for (int i = 0; i < count; ++i)
      if (corner >> i & 1) step[axes[i]] = d[axes[i]];
    node.push_back(sheets.node(r, Direction::of(step[0], step[1], step[2]).q()));
    link.is_equation = node.back() != Sheets::kNoNode;
  }
  if (!link.is_equation) {
    node.resize(link.first + 1);
    node.push_back(sheets.node(r, q));
    link.size = 2;
  }
  items.push_back(link);
}

/// Of all one-way links, ascending.
TornLinks links_of(const Grid& grid, const Sheets& sheets) {
  constexpr std::uint64_t kWords = 256;
  return sum_of_blocks<TornLinks>(sheets.words_of_ends(), kWords, all_threads(),
                                  [&](std::uint64_t begin, std::uint64_t end) {
                                    TornLinks links;
                                    sheets.for_each_end(begin, end, [&](RecordIndex r, int q) {
                                      links.add(sheets, r, q, tear_fraction(grid, r, q));
                                    });
                                    return links;
                                  });
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Of an equation with kSize nodes: adds the normal matrix, times v, to `product`.
template <int kSize>
void add_normal(const Node* node, double t, const std::vector<double>& v,
                std::vector<double>& product) {
  // Each axis multiplies by t where a corner is ahead along it, and else by 1 - t.
  std::array<double, kSize> weight{1};
  for (int half = 1; half < kSize; half *= 2)
    for (int k = 0; k < half; ++k) {
      weight[k + half] = weight[k] * t;
      weight[k] *= 1 - t;
    }
  double sum = 0;
  for (int k = 0; k < kSize; ++k) sum += weight[k] * v[node[k]];
  for (int k = 0; k < kSize; ++k) product[node[k]] += weight[k] * sum;
}

/// Sets `product` to the normal matrix of the equations and of the start values, times v.
void set_normal(const TornLinks& links, const std::vector<double>& v, double start_weight,
                std::vector<double>& product) {
  for (std::size_t i = 0; i < v.size(); ++i) product[i] = start_weight * v[i];
  for (const TornLink& link : links.items) {
    if (!link.is_equation) continue;
    const auto add = link.size == 2   ? add_normal<2>
                     : link.size == 4 ? add_normal<4>
                                      : add_normal<8>;
    add(&links.node[link.first], link.t, v, product);
  }
}

/// Moves `value` towards the equations by conjugate gradients.
void solve(const TornLinks& links, std::vector<double>& value) {
  std::vector<double> rest(value.size()), image(value.size());
  set_normal(links, value, 0, rest);
  for (double& x : rest) x = -x;
  std::vector<double> way = rest;
  double size = dot(rest, rest);
  for (int step = 0; step < kSteps && size > 0; ++step) {
    set_normal(links, way, kStartWeight, image);
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

/// How far the plane that fits the tear fractions around a ghost best is from it.
double distance(const Grid& grid, const Sheets& sheets, Node ghost) {
  Plane plane;
  for (const auto& [r, q] : sheets.ends_of_ghost(ghost)) {
    const auto d = Direction(q).step();
    const double beyond = tear_fraction(grid, r, q) - 1;
    plane.add({beyond * d[0], beyond * d[1], beyond * d[2]});
  }
  return plane.distance();
}

}  // namespace

TearFunction::TearFunction(const Grid& grid, const Sheets& sheets) {
  TornLinks links = links_of(grid, sheets);
  std::vector<std::uint64_t> is_near((std::size_t{grid.records()} + sheets.ghosts()) / 64 + 1);
  for (const Node node : links.node) is_near[node / 64] |= std::uint64_t{1} << node % 64;
  is_near_ = RankedBits(is_near);
  // Nodes are numbered in the order in which they come: sums are made in this order.
  constexpr Node kNone = ~Node{0};
  std::vector<Node> number(is_near_.count(), kNone), numbered;
  std::vector<double> value;
  const auto number_of = [&](Node node) {
    Node& found = number[is_near_.rank(node)];
    if (found == kNone) {
      found = static_cast<Node>(numbered.size());
      numbered.push_back(node);
      value.push_back(kFarthest);
    }
    return found;
  };
  Plane plane;  // of the links that one record has
  for (std::size_t i = 0; i < links.items.size(); ++i) {
    const TornLink& link = links.items[i];
    Node* const node = &links.node[link.first];
    const RecordIndex r = node[0];
    const auto d = Direction(link.q).step();
    plane.add({link.t * d[0], link.t * d[1], link.t * d[2]});
    const Node own = number_of(r);
    number_of(node[link.size - 1]);
    if (i + 1 == links.items.size() || links.node[links.items[i + 1].first] != r) {
      value[own] = plane.distance();
      plane = {};
    }
    for (int k = 0; k < link.size; ++k) node[k] = number_of(node[k]);
  }
  for (std::size_t i = 0; i < value.size(); ++i)
    if (sheets.is_ghost(numbered[i])) value[i] = -distance(grid, sheets, numbered[i]);
  solve(links, value);
  values_.resize(value.size());
  for (std::size_t i = 0; i < value.size(); ++i)
    values_[is_near_.rank(numbered[i])] = static_cast<float>(
        sheets.is_ghost(numbered[i]) ? std::min(value[i], -kLeast) : std::max(value[i], kLeast));
}

}  // namespace hapgrid
