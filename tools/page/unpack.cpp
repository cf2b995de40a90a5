#include <bit>
#include <cstring>
#include <utility>

#include "libcore/grid/grid.hpp"
#include "tools/page/packed_grid.hpp"

namespace hapgrid {

namespace {

template <class T>
T read_one(const unsigned char*& from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  from += sizeof value;
  return value;
}

/// The next column of `count` numbers of type T, each of which use(i, number) takes.
template <class T, class Use>
void read_column(const unsigned char*& from, std::size_t count, const Use& use) {
  T number = 0;
  for (std::size_t i = 0; i < count; ++i) {
    T step = 0;
    for (std::size_t b = 0; b < sizeof(T); ++b)
      step = static_cast<T>(step | static_cast<T>(from[b * count + i]) << 8 * b);
    number = static_cast<T>(number + static_cast<T>(step >> 1 ^ -(step & 1)));
    use(i, number);
  }
  from += sizeof(T) * count;
}

void read_links(const unsigned char*& from, const PackedHead& head, RecordColumns& columns) {
  columns.links.resize(std::size_t{head.records} * kDirections);
  for (std::size_t q = 0; q < kDirections; ++q)
    read_column<std::uint8_t>(from, head.records, [&](std::size_t r, std::uint8_t value) {
      columns.links[r * kDirections + q] = value;
    });
}

RecordFields read_fields(const unsigned char*& from, const PackedHead& head) {
  RecordFields fields;
  fields.energy.resize(head.records);
  fields.force.resize(head.records);
  read_column<std::uint32_t>(from, head.records, [&](std::size_t r, std::uint32_t bits) {
    fields.energy[r] = double{std::bit_cast<float>(bits)} * head.spacing;
  });
  for (std::size_t a = 0; a < 3; ++a)
    read_column<std::uint32_t>(from, head.records, [&](std::size_t r, std::uint32_t bits) {
      fields.force[r][a] = std::bit_cast<float>(bits);
    });
  return fields;
}

}  // namespace

UnpackedGrid unpack_grid(const unsigned char* from) {
  const auto head = read_one<PackedHead>(from);
  GridSpec spec;
  for (int a = 0; a < 3; ++a) {
    spec.box.origin[a] = head.origin[a];
    spec.box.counts[a] = head.counts[a];
  }
  spec.box.spacing = head.spacing;
  spec.state_size = head.has_own;
  spec.max_levels = kMaxLevels;
  spec.stored.shape = true;
  Scene scene;
  scene.box = spec.box;
  scene.length_unit = text_of(head.length_unit);
  scene.hip_radius = head.hip_radius;
  scene.largest_force = head.largest_force;
  std::vector<float> centres;
  std::vector<std::uint32_t> moved;
  for (std::uint32_t k = 0; k < head.spheres; ++k) {
    const auto sphere = read_one<PackedSphere>(from);
    scene.spheres.push_back({.radius = sphere.radius, .label = text_of(sphere.label)});
    for (std::uint32_t a = 0; a < 3; ++a) {
      centres.push_back(sphere.centre[a]);
      if (sphere.moves != 0) moved.push_back(3 * k + a);
    }
  }
  for (std::uint32_t k = 0; k < head.torsions; ++k)
    scene.torsions.emplace_back().spheres = read_one<std::array<std::uint32_t, 4>>(from);
  spec.spheres.resize(moved.size() / 3);

  const std::size_t records = head.records, row_size = head.has_own + moved.size();
  RecordColumns columns;
  columns.point.reserve(records);
  columns.level.reserve(records);
  columns.generation.resize(records);
  read_column<std::uint8_t>(from, spec.box.points(), [&](std::size_t p, std::uint8_t levels) {
    for (Level l = 0; l < levels; ++l) {
      columns.point.push_back(static_cast<PointIndex>(p));
      columns.level.push_back(l);
    }
  });
  read_links(from, head, columns);
  RecordFields fields = read_fields(from, head);
  columns.rows.resize(records * row_size);
  if (head.has_own != 0)
    read_column<std::uint32_t>(from, records, [&](std::size_t r, std::uint32_t bits) {
      columns.rows[r * row_size] = double{std::bit_cast<float>(bits)};
    });
  for (std::size_t c = head.has_own; c < row_size; ++c)
    read_column<std::uint16_t>(from, records, [&](std::size_t r, std::uint16_t steps) {
      columns.rows[r * row_size + c] = head.shape_low + head.shape_step * steps;
    });
  // No record is of the generation of the grid, so none is in its frontier.
  return {Grid(std::move(spec), /*generation=*/1, columns),
          std::move(fields),
          head.by_energy != 0,
          std::move(scene),
          std::move(centres),
          std::move(moved)};
}

}  // namespace hapgrid
