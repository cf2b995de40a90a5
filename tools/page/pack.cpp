#include "tools/page/pack.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/base/text.hpp"
#include "libcore/check/invariants.hpp"
#include "libcore/model/fields.hpp"
#include "tools/common/node_forces.hpp"
#include "tools/common/scene.hpp"
#include "tools/common/traversals.hpp"
#include "tools/page/packed_grid.hpp"

namespace hapgrid {

namespace {

constexpr double kMaxForce = 3;     // newtons, the default of play
constexpr double kSeenPart = 200;   // of a spacing: less than a pixel
constexpr double kWeakPart = 0.01;  // of the largest force: the hand can begin there

template <class T>
void append(std::string& out, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  static_assert(std::endian::native == std::endian::little);
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T, class Of>
void append_column(std::string& out, std::size_t count, const Of& of) {
  const std::size_t at = out.size();
  out.resize(at + sizeof(T) * count);
  T before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const T number = of(i);
    const auto way = static_cast<std::make_signed_t<T>>(number - before);
    const auto step =
        static_cast<T>(static_cast<T>(way << 1) ^ static_cast<T>(way >> (8 * sizeof(T) - 1)));
    before = number;
    for (std::size_t b = 0; b < sizeof(T); ++b)
      out[at + b * count + i] = static_cast<char>(step >> 8 * b & 255);
  }
}

std::uint32_t bits_of(double value) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

/// The shapes of all records, and which spheres move.
struct Shapes {
  Shapes(const Grid& grid, const Fields& fields) : spheres(fields.spheres().size()) {
    const std::size_t size = 3 * spheres;
    centres.resize(grid.records() * size);
    moves.resize(spheres);
    for (RecordIndex r = 0; r < grid.records() && spheres > 0; ++r) {
      const std::span<float> mine = of(r);
      fields.shape(grid.box().position(grid.point(r)), grid.row(r), mine);
      for (std::size_t c = 0; c < size; ++c)
        if (mine[c] != centres[c]) moves[c / 3] = true;
    }
    for (std::size_t c = 0; c < centres.size(); ++c) {
      if (!moves[c % size / 3]) continue;
      low = std::min(low, double{centres[c]});
      high = std::max(high, double{centres[c]});
    }
  }
  std::span<float> of(RecordIndex r) {
    return std::span(centres).subspan(r * 3 * spheres, 3 * spheres);
  }
  std::size_t moving() const { return std::count(moves.begin(), moves.end(), true); }

  std::size_t spheres;
  std::vector<float> centres;
  std::vector<bool> moves;
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

/// Where the hand begins: to the left of the middle, at the nearest grid point on the viewer's side
/// at which no force acts, or at least none that is felt, and which lies on no wall. Where there is
/// none, as around an atom that is held, at the point of the lowest energy, or of the weakest
/// force.
Vec3 free_place(const Grid& grid, const RecordFields& fields, double largest, const Vec3& near) {
  const Box& box = grid.box();
  const Vec3 middle = 0.5 * (box.origin + box.high());
  const Vec3 wanted{0.7 * box.origin[0] + 0.3 * middle[0], middle[1], middle[2]};
  const bool has_energy = !fields.energy.empty();
  double top = 0;  // half of the highest energy above the lowest
  if (has_energy) {
    const auto [lowest, highest] = std::minmax_element(fields.energy.begin(), fields.energy.end());
    top = 0.5 * (*lowest + *highest);
  }
  const auto nearest = [&](const auto& cost) {
    double least = std::numeric_limits<double>::infinity();
    std::optional<Vec3> found;
    for (std::uint64_t p = 0; p < box.points(); ++p) {
      const auto point = static_cast<PointIndex>(p);
      const double of_point = cost(grid.first(point), box.position(point));
      if (of_point >= least) continue;
      least = of_point;
      found = box.position(point);
    }
    return found;
  };
  for (const double weak : {0.0, kWeakPart * largest}) {
    const std::optional<Vec3> found = nearest([&](RecordIndex r, const Vec3& x) {
      const bool fits = length_of(fields.force[r]) <= weak &&
                        (!has_energy || fields.energy[r] <= top) &&
                        dot(near, x - middle) >= -1e-9 * box.spacing;
      return fits ? length_of(x - wanted) : std::numeric_limits<double>::infinity();
    });
    if (found) return *found;
  }
  return nearest([&](RecordIndex r, const Vec3&) {
           return has_energy ? fields.energy[r] : length_of(fields.force[r]);
         })
      .value_or(middle);
}

/// Of the model by itself at each record; none where it has no such energy.
std::vector<double> own_energies(const Grid& grid, const Fields& fields) {
  std::vector<double> own;
  for (RecordIndex r = 0; r < grid.records() && fields.has_own_energy(); ++r)
    own.push_back(fields.own_energy(grid.row(r)));
  return own;
}

std::vector<std::array<double, 72>> profiles_of(const std::vector<Torsion>& torsions,
                                                const Grid& grid, const Fields& fields,
                                                Shapes& shapes, const std::vector<double>& own) {
  std::vector<std::array<double, 72>> profiles(torsions.size());
  std::vector<double> angles(own.size()), row(grid.state_size());
  for (std::size_t t = 0; t < torsions.size(); ++t) {
    auto& profile = profiles[t];
    profile.fill(std::numeric_limits<double>::quiet_NaN());
    if (own.empty()) continue;
    const auto of = [&](double part) -> double& {
      return profile[static_cast<std::size_t>(part + 36 + 72) % 72];
    };
    for (std::size_t r = 0; r < own.size(); ++r)  // in parts of the profile
      angles[r] = torsion_degrees(torsions[t], shapes.of(static_cast<RecordIndex>(r))) / 5;
    for (RecordIndex r = 0; r < grid.records(); ++r)
      for (int axis = 0; axis < 3; ++axis) {
        const int q = Direction::up(axis).q();
        const RecordIndex next = grid.destination(r, q);
        if (next == Grid::kNoRecord || grid.is_one_way(r, q)) continue;
        const double way = std::remainder(angles[next] - angles[r], 72);
        const auto [low, high] = std::minmax({angles[r], angles[r] + way});
        for (double part = std::ceil(low); part <= high; ++part) {
          const double u = way == 0 ? 0 : (part - angles[r]) / way;
          for (std::size_t c = 0; c < row.size(); ++c) {
            const double here = grid.state(r)[c];
            row[c] =
                std::lerp(here, nearest(grid.spec().equality, c, grid.state(next)[c], here), u);
          }
          of(part) = std::fmin(of(part), fields.own_energy(row));
        }
      }
    const auto lowest = std::min_element(own.begin(), own.end());
    if (std::isfinite(angles[lowest - own.begin()]))
      of(std::round(angles[lowest - own.begin()])) = *lowest;
  }
  return profiles;
}

void append_columns(std::string& out, const Grid& grid, const RecordFields& fields, double lowest,
                    const PackedHead& head, Shapes& shapes, const std::vector<double>& own) {
  const std::size_t records = grid.records();
  const auto at = [](std::size_t r) { return static_cast<RecordIndex>(r); };
  append_column<std::uint8_t>(out, grid.box().points(), [&](std::size_t p) {
    return static_cast<std::uint8_t>(grid.levels(static_cast<PointIndex>(p)));
  });
  for (std::size_t q = 0; q < kDirections; ++q)
    append_column<std::uint8_t>(out, records, [&](std::size_t r) { return grid.links(at(r))[q]; });
  append_column<std::uint32_t>(out, records, [&](std::size_t r) {
    return head.by_energy != 0 ? bits_of((fields.energy[r] - lowest) / head.spacing) : 0;
  });
  for (std::size_t a = 0; a < 3; ++a)
    append_column<std::uint32_t>(out, records,
                                 [&](std::size_t r) { return bits_of(fields.force[r][a]); });
  if (!own.empty())
    append_column<std::uint32_t>(out, records, [&](std::size_t r) { return bits_of(own[r]); });
  for (std::size_t c = 0; c < 3 * shapes.spheres; ++c)
    if (shapes.moves[c / 3])
      append_column<std::uint16_t>(out, records, [&](std::size_t r) {
        const double above = shapes.of(at(r))[c] - head.shape_low;
        return static_cast<std::uint16_t>(std::lround(above / head.shape_step));
      });
}

std::string packed_bytes(const Grid& grid, const RecordFields& fields, std::optional<double> lowest,
                         const Scene& scene, Shapes& shapes, const std::vector<double>& own) {
  PackedHead head{};
  write_text(scene.length_unit, head.length_unit);
  for (int a = 0; a < 3; ++a) {
    head.origin[a] = scene.box.origin[a];
    head.counts[a] = scene.box.counts[a];
  }
  head.spacing = scene.box.spacing;
  if (shapes.moving() > 0) {
    head.shape_low = shapes.low;
    head.shape_step = std::max((shapes.high - shapes.low) / 65535, head.spacing / kSeenPart);
  }
  head.hip_radius = scene.hip_radius;
  head.largest_force = scene.largest_force;
  head.records = grid.records();
  head.spheres = static_cast<std::uint32_t>(shapes.spheres);
  head.torsions = static_cast<std::uint32_t>(scene.torsions.size());
  head.by_energy = lowest.has_value();
  head.has_own = !own.empty();
  std::string out;
  append(out, head);
  for (std::size_t k = 0; k < shapes.spheres; ++k) {
    const float* const x = shapes.centres.data() + 3 * k;
    PackedSphere sphere{{}, scene.spheres[k].radius, {x[0], x[1], x[2]}, shapes.moves[k]};
    write_text(scene.spheres[k].label, sphere.label);
    append(out, sphere);
  }
  for (const Torsion& torsion : scene.torsions) append(out, torsion.spheres);
  append_columns(out, grid, fields, lowest.value_or(0), head, shapes, own);
  return out;
}

}  // namespace

std::string spacing_for(const GridSpec& spec, double part) {
  int sides = 0;
  for (const auto count : spec.box.counts) sides += count > 1;
  // Upwards, in steps of two digits.
  const double spacing = 1.05 * spec.box.spacing * std::pow(part, -1.0 / std::max(sides, 1));
  const double step = std::pow(10, std::floor(std::log10(spacing)) - 1);
  const std::string text = rounded(step * std::ceil(spacing / step));
  return spec.length_unit.empty() ? text : text + " " + printable_line(spec.length_unit);
}

PackedGrid pack_grid(const Grid& grid, const std::string& name, const MakeModel& create,
                     const Vec3& near) {
  require_playable(grid, name);
  const GridSpec& spec = grid.spec();
  const Fields fields(spec, create, /*wants_shape=*/true);
  const double bytes = 24.0 * grid.records() * static_cast<double>(fields.spheres().size());
  if (bytes > kMostShapeBytes)
    throw Error(
        format("{}: {} spheres at {} records need {} MB of a browser's memory, and {} MB "
               "is the most: a grid of a spacing of {} would fit",
               name, fields.spheres().size(), grid.records(), rounded(bytes / 1e6),
               kMostShapeBytes / 1e6, spacing_for(spec, kMostShapeBytes / bytes)));
  const RecordFields of_records = record_fields(grid, create, all_threads());
  const NodeForces forces = node_forces(grid, of_records);
  const auto traversal = traversals(TraversalRule::kBranch, grid, create)();
  add_ghosts(*forces.nodes, grid, *traversal->branch_nodes());

  PackedGrid packed;
  packed.scene = scene_of(spec, fields);
  packed.scene.largest_force = std::min(kMaxForce, largest_force(*forces.nodes));
  packed.force_scale = fields.force_scale();
  if (forces.has_energy())
    packed.lowest = *std::min_element(of_records.energy.begin(), of_records.energy.end());

  Frame& first = packed.first;
  const Vec3 start = free_place(grid, of_records, packed.scene.largest_force, near);
  traversal->start(start);
  first.position = first.hip = first.hand = start;
  first.row.assign(traversal->row().begin(), traversal->row().end());
  first.centres.resize(3 * fields.spheres().size());
  fields.shape(start, traversal->row(), first.centres);
  Shapes shapes(grid, fields);
  packed.snaps = grid.records() > grid.box().points();
  const std::vector<double> own = own_energies(grid, fields);
  packed.profiles = profiles_of(packed.scene.torsions, grid, fields, shapes, own);
  packed.bytes = packed_bytes(grid, of_records, packed.lowest, packed.scene, shapes, own);
  return packed;
}

}  // namespace hapgrid
