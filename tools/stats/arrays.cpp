#include "tools/stats/arrays.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "tools/stats/npz.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kBuffer = 1 << 20;  // bytes

/// The array `name` with a row of `width` numbers for each record, which `fill(r, row)` writes.
template <class T, class Fill>
void add_rows(NpzFile& file, const Grid& grid, const std::string& name, const std::string& type,
              std::vector<std::uint64_t> row_shape, Fill&& fill) {
  std::uint64_t width = 1;
  for (const std::uint64_t size : row_shape) width *= size;
  const std::uint64_t records = grid.records();
  row_shape.insert(row_shape.begin(), records);
  file.begin(name, type, row_shape, records * width * sizeof(T));
  if (width == 0) return;
  const std::uint64_t at_once = std::max<std::uint64_t>(1, kBuffer / (width * sizeof(T)));
  std::vector<T> rows;
  for (std::uint64_t begin = 0; begin < records; begin += at_once) {
    const std::uint64_t end = std::min(records, begin + at_once);
    rows.resize((end - begin) * width);
    for (std::uint64_t r = begin; r < end; ++r)
      fill(static_cast<RecordIndex>(r), rows.data() + (r - begin) * width);
    file.write(std::as_bytes(std::span(rows)));
  }
}

template <class T>
void add_destinations(NpzFile& file, const Grid& grid, const std::string& type) {
  add_rows<T>(file, grid, "destination", type, {kDirections}, [&](RecordIndex r, T* row) {
    for (int q = 0; q < kDirections; ++q) {
      const RecordIndex to = grid.destination(r, q);
      row[q] = to == Grid::kNoRecord ? T{-1} : static_cast<T>(to);
    }
  });
}

void add_stored(NpzFile& file, const Grid& grid) {
  const GridSpec& spec = grid.spec();
  const auto add = [&](const std::string& name, std::vector<std::uint64_t> shape,
                       std::uint32_t offset, std::size_t width) {
    add_rows<double>(file, grid, name, "'<f8'", std::move(shape),
                     [=, &grid](RecordIndex r, double* row) {
                       std::copy_n(grid.row(r).begin() + offset, width, row);
                     });
  };
  add("state", {spec.state_size}, 0, spec.state_size);
  if (spec.stored.force) add("force", {3}, spec.force_offset(), 3);
  if (spec.stored.energy) add("energy", {}, spec.energy_offset(), 1);
  if (spec.stored.shape)
    add("shape", {spec.spheres.size(), 3}, spec.shape_offset(), 3 * spec.spheres.size());
}

/// What a tick is in the array: numpy's fields, without gaps.
struct [[gnu::packed]] TickRow {
  double t;
  std::array<double, 3> hip, force, sent;
  std::array<std::uint8_t, 8> levels;
  std::uint32_t flags;
  double lateness_us, compute_us;
};
constexpr const char* kTickType =
    "[('t', '<f8'), ('hip', '<f8', (3,)), ('force', '<f8', (3,)), ('sent', '<f8', (3,)), "
    "('levels', '|u1', (8,)), ('flags', '<u4'), ('lateness_us', '<f8'), ('compute_us', '<f8')]";

}  // namespace

void write_grid_arrays(const Grid& grid, const std::string& name) {
  OutputFile output(name);
  NpzFile file(output);
  const Box& box = grid.box();
  add_rows<std::uint32_t>(file, grid, "point", "'<u4'", {3},
                          [&](RecordIndex r, std::uint32_t* row) {
                            const GridCoordinates c = box.coordinates(grid.point(r));
                            std::copy(c.begin(), c.end(), row);
                          });
  add_rows<std::uint8_t>(file, grid, "level", "'|u1'", {},
                         [&](RecordIndex r, std::uint8_t* row) { *row = grid.level(r); });
  add_rows<std::uint32_t>(
      file, grid, "generation", "'<u4'", {},
      [&](RecordIndex r, std::uint32_t* row) { *row = grid.record_generation(r); });
  add_stored(file, grid);
  if (grid.records() <= std::numeric_limits<std::int32_t>::max())
    add_destinations<std::int32_t>(file, grid, "'<i4'");
  else
    add_destinations<std::int64_t>(file, grid, "'<i8'");
  if (grid.has_tears())
    add_rows<std::uint8_t>(file, grid, "tear", "'|u1'", {kDirections},
                           [&](RecordIndex r, std::uint8_t* row) {
                             std::copy_n(grid.tears(r).begin(), kDirections, row);
                           });
  file.add("origin", "'<f8'", {3}, std::vector<double>(box.origin.begin(), box.origin.end()));
  file.add("spacing", "'<f8'", {}, std::vector<double>{box.spacing});
  file.add("counts", "'<u4'", {3},
           std::vector<std::uint32_t>(box.counts.begin(), box.counts.end()));
  file.end();
  output.commit();
}

void write_session_arrays(
    const SessionHeader& header, std::uint64_t count,
    const std::function<void(const std::function<void(const TickRecord&)>&)>& each,
    const std::string& name) {
  OutputFile output(name);
  NpzFile file(output);
  file.begin("ticks", kTickType, {count}, count * sizeof(TickRow));
  std::vector<TickRow> rows;
  const auto flush = [&] {
    file.write(std::as_bytes(std::span(rows)));
    rows.clear();
  };
  each([&](const TickRecord& tick) {
    TickRow row{header.time_of(tick.number), {}, {}, {}, {}, tick.flags, tick.lateness_ns / 1e3,
                tick.compute_ns / 1e3};
    std::memcpy(&row.hip, tick.hip.data(), sizeof row.hip);
    std::memcpy(&row.force, tick.raw_force.data(), sizeof row.force);
    std::memcpy(&row.sent, tick.force.data(), sizeof row.sent);
    std::copy(tick.levels.begin(), tick.levels.end(), row.levels.begin());
    rows.push_back(row);
    if (rows.size() * sizeof(TickRow) >= kBuffer) flush();
  });
  flush();
  file.end();
  output.commit();
}

}  // namespace hapgrid
