// The force from the energy at the nodes: what it is exact for, that it gives no energy, and that
// it jumps with the state alone.
#include "libcore/follow/node_force.hpp"

#include "libcore/follow/branch_traversal.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"
#include "tests/unit/follow/places.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

/// Numbers with 20 bits in [-1, 1): floats without rounding.
float exact(std::mt19937_64& random) {
  return static_cast<float>(static_cast<double>(random() >> 44) * 0x1p-19 - 1);
}

NodeEnergy random_node(std::mt19937_64& random) {
  NodeEnergy node;
  node.energy = exact(random);
  for (float& s : node.slope) s = exact(random);
  for (float& m : node.mixed) m = exact(random);
  return node;
}

/// The work of `force`, a function of the place, from a to b: by Gauss's rule with five points,
/// which is exact for a polynomial of degree 9. Along a line in a cell the force has degree 8.
template <class Force>
double work(const Vec3& a, const Vec3& b, Force&& force) {
  constexpr double kAt[] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                            0.9061798459386640};
  constexpr double kWeight[] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                0.4786286704993665, 0.2369268850561891};
  double sum = 0;
  for (int i = 0; i < 5; ++i)
    sum += kWeight[i] / 2 * dot(force(a + (1 + kAt[i]) / 2 * (b - a)), b - a);
  return sum;
}

RecordFields random_fields(const Grid& grid, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto energy = [&](const Vec3&) { return exact(random); };
  return fields_of(grid, energy, [&](const Vec3&) {
    return Vec3{exact(random), exact(random), exact(random)};
  });
}

/// All cubic polynomials but x y z, with random coefficients.
struct Cubic {
  explicit Cubic(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 4; ++k) {
          c[i][j][k] = uniform(random, -1, 1);
          if (i + j + k > 3 || i * j * k > 0) c[i][j][k] = 0;
        }
  }
  double energy(const Vec3& x) const {
    double sum = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 4; ++k)
          sum += c[i][j][k] * std::pow(x[0], i) * std::pow(x[1], j) * std::pow(x[2], k);
    return sum;
  }
  /// By central differences, from which Richardson takes the part of the third derivative.
  Vec3 force(const Vec3& x) const {
    Vec3 f;
    for (int a = 0; a < 3; ++a) {
      const auto difference = [&](double e) {
        Vec3 low = x, high = x;
        low[a] -= e;
        high[a] += e;
        return (energy(low) - energy(high)) / (2 * e);
      };
      f[a] = (4 * difference(0.25) - difference(0.5)) / 3;
    }
    return f;
  }
  double c[4][4][4];
};

Vec3 random_part(std::mt19937_64& random) {
  return {uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1)};
}

}  // namespace

TEST_CASE("in a cell the work of the force is what the energy loses") {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200; ++i) {
    std::array<NodeEnergy, 8> nodes;
    NodeCorners corners;
    for (int k = 0; k < 8; ++k) {
      nodes[k] = random_node(random);
      corners[k] = &nodes[k];
    }
    const Vec3 a = random_part(random), b = random_part(random);
    const double done = work(a, b, [&](const Vec3& x) { return hermite_force(corners, x); });
    // 64 terms below 2, in doubles: some hundred roundings of 2^-53.
    CHECK(std::abs(done - (hermite_energy(corners, a) - hermite_energy(corners, b))) < 1e-13);
    // At a corner both are what the corner has.
    const int k = static_cast<int>(random() % 8);
    const Vec3 at{static_cast<double>(k & 1), static_cast<double>(k >> 1 & 1),
                  static_cast<double>(k >> 2)};
    CHECK(hermite_energy(corners, at) == nodes[k].energy);
    for (int c = 0; c < 3; ++c) {
      CHECK(hermite_force(corners, at)[c] == -nodes[k].slope[c]);
      CHECK(mean_force(corners, at)[c] == -nodes[k].slope[c]);
    }
  }
}

TEST_CASE("on a branch no closed way of the hand gains energy") {
  const Box box{{0.3, -2, 5}, 0.25, {5, 6, 4}};
  const Grid grid = random_grid(box, 1, 1, 2);
  const auto map = std::make_shared<const BranchNodes>(grid);
  const auto energies =
      std::make_shared<const NodeEnergies>(node_energies(grid, random_fields(grid, 2), map.get()));
  BranchTraversal t(grid, map);
  NodeForce force(energies, box, hermite_force);
  std::mt19937_64 random(2);
  const Vec3 home = random_point(box, random);
  Vec3 at = home;
  double gained = 0, turned_over = 0;
  // A leg ends in the closed cell where it began, and often on a face, where the next cell begins.
  const auto go = [&](const Vec3& to) {
    const double done = work(at, to, [&](const Vec3& x) {
      REQUIRE(t.step(x).usable());
      return force(t);
    });
    gained += done;
    turned_over += std::abs(done);
    at = to;
  };
  t.start(at);
  std::vector<Vec3> way{at};
  for (int leg = 0; leg < 3000; ++leg) {
    // Into the neighbouring cell of a face on which the hand is.
    Vec3 inside = at;
    for (int a = 0; a < 3; ++a) {
      const double middle = face(box, a, static_cast<int>(random() % (box.counts[a] - 1)));
      if (std::abs(middle - at[a]) < 0.25) inside[a] = at[a] + 0.01 * (middle - at[a]);
    }
    Cell cell;
    for (int a = 0; a < 3; ++a)
      cell[a] = std::clamp(static_cast<int>((inside[a] - box.origin[a]) / box.spacing), 0,
                           static_cast<int>(box.counts[a]) - 2);
    const Vec3 to = random_point_in(box, cell, random);
    bool is_in = true;  // the same closed cell
    for (int a = 0; a < 3; ++a)
      is_in &= at[a] >= face(box, a, cell[a]) && at[a] <= face(box, a, cell[a] + 1);
    if (!is_in) continue;
    go(to);
    way.push_back(to);
  }
  way.pop_back();
  REQUIRE(way.size() > 1000);
  REQUIRE(turned_over > 50);
  const double there = gained;
  for (; !way.empty(); way.pop_back()) go(way.back());
  CHECK(at == home);
  CHECK(std::abs(there) > 1e-3);
  CHECK(std::abs(gained) < 1e-11);  // the roundings of some 1e4 works below 1
}

TEST_CASE("inside a grid a cubic energy comes back") {
  const Box box{{0, 0, 0}, 1, {5, 5, 5}};
  const Grid grid = random_grid(box, 1, 1, 3);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Cubic cubic(seed);
    const RecordFields fields = fields_of(
        grid, [&](const Vec3& x) { return cubic.energy(x); },
        [&](const Vec3& x) { return cubic.force(x); });
    const auto energies = std::make_shared<const NodeEnergies>(node_energies(grid, fields));
    double largest = 0;
    for (const double e : fields.energy) largest = std::max(largest, std::abs(e));
    PaperTraversal t(grid);
    NodeForce force(energies, box, hermite_force);
    std::mt19937_64 random(seed);
    for (int i = 0; i < 300; ++i) {
      // The mixed derivatives are differences to both sides: exact one spacing from the box's.
      const Vec3 x{uniform(random, 1, 3), uniform(random, 1, 3), uniform(random, 1, 3)};
      t.step(x);
      const Vec3 has = force(t), wanted = cubic.force(x);
      // The roundings of floats, times 1.5 for the slope between two values.
      for (int a = 0; a < 3; ++a) CHECK(std::abs(has[a] - wanted[a]) < 8 * 1.5 * largest * 0x1p-24);
    }
  }
}

TEST_CASE("beside free points a quadratic energy comes back where the hand pushes") {
  // Half the square of how deep x lies behind a plane: force is linear behind it, and 0 before it.
  // Differences to both sides across the plane would miss the mixed derivatives of the points
  // behind it. All points of a cell are behind it where its first corner is.
  const Box box{{0, 0, 0}, 1, {6, 6, 6}};
  const Grid grid = random_grid(box, 1, 1, 4);
  const Vec3 n{0.5, 0.75, 0.25};
  const auto depth = [&](const Vec3& x) { return std::max(0.0, dot(n, x) - 3.3); };
  const auto push = [&](const Vec3& x) { return -depth(x) * n; };
  const RecordFields fields = fields_of(
      grid, [&](const Vec3& x) { return depth(x) * depth(x) / 2; }, push);
  const auto energies = std::make_shared<const NodeEnergies>(node_energies(grid, fields));
  PaperTraversal t(grid);
  NodeForce force(energies, box, hermite_force);
  std::mt19937_64 random(1);
  int pushed = 0;
  while (pushed < 300) {
    const Vec3 x{uniform(random, 0, 5), uniform(random, 0, 5), uniform(random, 0, 5)};
    if (depth({std::floor(x[0]), std::floor(x[1]), std::floor(x[2])}) == 0) continue;
    ++pushed;
    t.step(x);
    const Vec3 has = force(t), wanted = push(x);
    // The roundings of floats below 10, times 1.5 for the slope between two values.
    for (int a = 0; a < 3; ++a) CHECK(std::abs(has[a] - wanted[a]) < 8 * 1.5 * 10 * 0x1p-24);
  }
}

TEST_CASE("ghosts are exact where forces are linear") {
  // A branch where x + y / 16 < 4.2 and another one, to which it snaps: each ghost has a record
  // beside it from which the branch goes on straight back.
  const Box box{{0, 0, 0}, 1, {8, 5, 5}};
  const auto ends = [](const Vec3& x) { return x[0] + x[1] / 16 > 4.2; };
  const Neighbourhood around(box);
  RecordColumns columns;
  for (PointIndex p = 0; p < box.points(); ++p) {
    const bool behind = ends(box.position(p));
    for (int level = 0; level < (behind ? 1 : 2); ++level)  // level 0 is on both sides, 1 ends
      add_record(columns, around, p, static_cast<Level>(level), std::array{0.0},
                 [&](PointIndex to) { return level == 1 && !ends(box.position(to)); });
  }
  const Grid grid(spec_for(box, 1), 1, columns);
  const BranchNodes branches(grid);
  REQUIRE(branches.ghosts() > 25);
  const Vec3 stiffness[] = {{1, 0.5, -0.25}, {0.5, 2, 0.75}, {-0.25, 0.75, -1}};
  constexpr Vec3 kOnes{1, 1, 1};
  const auto force = [&](const Vec3& x) {
    return kOnes - Vec3{dot(stiffness[0], x), dot(stiffness[1], x), dot(stiffness[2], x)};
  };
  const auto energy = [&](const Vec3& x) { return -dot(force(x) + kOnes, x) / 2; };
  // The energy of the branch to which it snaps is that of the other one, moved up or down.
  for (const double moved : {-4.0, 0.0, 4.0}) {
    RecordFields fields = fields_of(grid, energy, force);
    for (RecordIndex r = 0; r < grid.records(); ++r)
      if (r == grid.first(grid.point(r))) fields.energy[r] += moved;
    const NodeEnergies nodes = node_energies(grid, fields, &branches);
    const double lowest = *std::min_element(fields.energy.begin(), fields.energy.end());
    for (Node ghost = grid.records(); ghost < grid.records() + branches.ghosts(); ++ghost) {
      const Vec3 x = box.position(branches.point(ghost));
      // No model snaps to a state of more energy, so the ghost is not below that either. Small
      // whole multiples of 1/8: no rounding but that of the averages, to floats below 128.
      const double expected = energy(x) + std::max(moved, 0.0) - lowest;
      CHECK(std::abs(nodes[ghost].energy - expected) < 128 * 0x1p-24);
      for (int a = 0; a < 3; ++a) {
        CHECK(std::abs(nodes[ghost].slope[a] + force(x)[a]) < 16 * 0x1p-24);
        const int b = (a + 1) % 3;
        CHECK(std::abs(nodes[ghost].mixed[3 - a - b] - stiffness[a][b]) < 0x1p-24);
      }
    }
  }
}

TEST_CASE("whatever the links are, the force jumps only where the state does") {
  constexpr int kTicks = 20000;
  const Box box{{0, 0, 0}, 0.5, {7, 6, 5}};
  std::uint64_t changes = 0, faded = 0;
  for (unsigned levels = 2; levels <= 4; ++levels) {
    const Grid grid = random_grid(box, 1, levels, levels);
    const auto map = std::make_shared<const BranchNodes>(grid);
    const auto energies = std::make_shared<const NodeEnergies>(
        node_energies(grid, random_fields(grid, levels), map.get()));
    BranchTraversal t(grid, map);
    NodeForce force(energies, box, hermite_force);
    std::mt19937_64 random(levels);
    Vec3 x = random_point(box, random);
    t.start(x);
    Vec3 before = force(t);
    double largest_step = 0, since = 0;  // spacings since the nodes changed
    bool is_plain = true;
    const std::uint64_t allocated = allocations();
    for (int leg = 0; leg < 8; ++leg) {
      const Vec3 from = x, to = random_point(box, random);
      for (int i = 1; i <= kTicks; ++i) {
        x = from + static_cast<double>(i) / kTicks * (to - from);
        const std::uint64_t jumps = t.jumps();
        const auto nodes = t.nodes();
        const auto cell = t.cell();
        t.step(x);
        const Vec3 now = force(t);
        since = t.nodes() == nodes ? since + length_of(to - from) / box.spacing / kTicks : 0;
        if (since > 0.5) {
          NodeCorners corners;
          for (int k = 0; k < 8; ++k) corners[k] = &(*energies)[t.nodes()[k]];
          is_plain &= now == hermite_force(corners, t.part());
          ++faded;
        }
        if (t.jumps() == jumps) {
          changes += t.cell() == cell && t.nodes() != nodes;
          largest_step = std::max(largest_step, length_of(now - before));
        }
        before = now;
      }
    }
    CHECK(allocations() == allocated);
    CHECK(is_plain);
    // A tick is 5.2e-4 spacings at most. Energies differ by less than 12 there (ghosts included)
    // and slopes by less than 6, so an axis of the force changes by less than 6 x 12 + 4 x 6 + 2 x
    // 6 in a spacing; an offset of 100 N fades by 0.11 N. What jumps, jumps by newtons.
    CHECK(largest_step < 0.3);
  }
  CHECK(changes > 20);
  CHECK(faded > 1000);
}
