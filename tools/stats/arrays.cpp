#include "tools/stats/arrays.hpp"

#include <bit>
#include <span>
#include <utility>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

static_assert(std::endian::native == std::endian::little);

namespace {

/// An array whose rows have fields, as numpy.load() opens it, written piece by piece, so that it
/// may be a pipe. Source: numpy, "NEP 1: A simple file format for NumPy arrays", version 1.0.
class NpyFile {
 public:
  /// @param fields of a row, as numpy's descr names them
  NpyFile(const std::string& name, const std::string& fields, std::uint64_t rows) : output_(name) {
    constexpr std::size_t kMagic = 10, kAligned = 64;
    std::string header =
        format("{{'descr': [{}], 'fortran_order': False, 'shape': ({},), }}", fields, rows);
    header.resize((kMagic + header.size() + 1 + kAligned - 1) / kAligned * kAligned - kMagic - 1,
                  ' ');
    header += '\n';
    output_.write(std::string("\x93NUMPY\x01\x00", 8));
    output_.write(std::string{static_cast<char>(header.size() & 0xff),
                              static_cast<char>(header.size() >> 8)});
    output_.write(header);
  }
  /// The next numbers of a row.
  template <class T>
  void add(const T* numbers, std::size_t count) {
    const auto bytes = std::as_bytes(std::span(numbers, count));
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    if (buffer_.size() >= kBuffer) flush();
  }
  template <class T>
  void add(T number) {
    add(&number, 1);
  }
  void commit() {
    flush();
    output_.commit();
  }

 private:
  static constexpr std::size_t kBuffer = 1 << 20;

  void flush() {
    output_.write(std::span(std::as_const(buffer_)));
    buffer_.clear();
  }

  OutputFile output_;
  std::vector<std::byte> buffer_;
};

}  // namespace

void write_grid_array(const Grid& grid, const std::string& name) {
  const GridSpec& spec = grid.spec();
  std::string fields = format(
      "('point', '<u4', (3,)), ('level', '|u1'), ('generation', '<u4'), "
      "('destination', '<i4', (26,)), ('state', '<f8', ({},))",
      spec.state_size);
  // These are a row of the grid, in its order.
  if (spec.stored.force) fields += ", ('force', '<f8', (3,))";
  if (spec.stored.energy) fields += ", ('energy', '<f8')";
  if (spec.stored.shape) fields += format(", ('shape', '<f8', ({}, 3))", spec.spheres.size());
  NpyFile file(name, fields, grid.records());
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    file.add(grid.box().coordinates(grid.point(r)).data(), 3);
    file.add(grid.level(r));
    file.add(grid.record_generation(r));
    for (int q = 0; q < kDirections; ++q)
      file.add(static_cast<std::int32_t>(grid.destination(r, q)));
    file.add(grid.row(r).data(), grid.row(r).size());
  }
  file.commit();
}

void write_session_array(SessionReader& session, std::uint64_t count, const std::string& name) {
  NpyFile file(
      name,
      "('t', '<f8'), ('hip', '<f8', (3,)), ('force', '<f8', (3,)), ('sent', '<f8', (3,)), "
      "('levels', '|u1', (8,)), ('flags', '<u4'), ('lateness_us', '<f8'), ('compute_us', '<f8')",
      count);
  session.rewind();
  for (std::vector<TickRecord> ticks; session.next(ticks);)
    for (const TickRecord& tick : ticks) {
      file.add(session.header().time_of(tick.number));
      for (const Vec3& v : {tick.hip, tick.raw_force, tick.force}) file.add(v.data(), 3);
      file.add(tick.levels.data(), tick.levels.size());
      file.add(std::uint32_t{tick.flags});
      file.add(tick.lateness_ns / 1e3);
      file.add(tick.compute_ns / 1e3);
    }
  file.commit();
}

void write_frames_array(SceneReader reader, const std::string& name) {
  std::vector<Frame> frames;
  try {
    for (Frame frame; reader.next(frame);) frames.push_back(frame);
  } catch (const CutError&) {  // play was stopped there
  }
  const Scene& scene = reader.scene();
  std::vector<float> radii;
  for (const Sphere& sphere : scene.spheres) radii.push_back(sphere.radius);
  NpyFile file(
      name,
      format("('t', '<f8'), ('tick', '<u8'), ('hip', '<f8', (3,)), ('position', '<f8', (3,)), "
             "('sent', '<f8', (3,)), ('energy', '<f8'), ('state', '<f8', ({},)), "
             "('shape', '<f4', ({}, 3)), ('radius', '<f4', ({},)), ('jumps', '<u8'), "
             "('own_energy', '<f8'), ('hand', '<f8', (3,))",
             scene.state_size, radii.size(), radii.size()),
      frames.size());
  for (const Frame& frame : frames) {
    file.add(frame.time_s);
    file.add(frame.tick);
    for (const Vec3& v : {frame.hip, frame.position, frame.force}) file.add(v.data(), 3);
    file.add(frame.energy);
    file.add(frame.row.data(), frame.row.size());
    file.add(frame.centres.data(), frame.centres.size());
    file.add(radii.data(), radii.size());
    file.add(frame.jumps);
    file.add(frame.own_energy);
    file.add(frame.hand.data(), 3);
  }
  file.commit();
}

}  // namespace hapgrid
