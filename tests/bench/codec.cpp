// Bytes a record and speed of finished grids: plain, coded without loss, and with a precision of
// 1e-4 of each component's range. In one thread: `bench_codec [GRID...]`.
//
// Without a GRID the reference field: n = 9 on 64^3 points, one level, component c at x in [0, 1]^3
// is the sum over m = 1, 2, 3 of 1/m sin(2 pi (k . x) + c + m), where k_a = 1/2 + frac(phi (27 m +
// 9 a + c)), a = 0, 1, 2: half a wave to one and a half in the box along each axis. Once rounded to
// float, as many models' states are, and once as doubles.
//
// MB are 10^6 bytes of the records before any compression (record_bytes() each).
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <utility>
#include <vector>

#include "libcore/shard/finish.hpp"
#include "libcore/shard/load.hpp"
#include "libcore/shard/reader.hpp"
#include "libcore/shard/writer.hpp"

namespace {

using namespace hapgrid;

/// Irrational ratios: with whole ones the same numbers come again and again, which no field does.
double wave_number(int c, int m, int axis) {
  return 0.5 + std::fmod(std::numbers::phi * (27 * m + 9 * axis + c), 1);
}

double reference(int c, const Vec3& at) {
  double sum = 0;
  for (int m = 1; m <= 3; ++m) {
    double phase = c + m;
    for (int a = 0; a < 3; ++a) phase += 2 * std::numbers::pi * wave_number(c, m, a) * at[a];
    sum += std::sin(phase) / m;
  }
  return sum;
}

Grid reference_grid(bool floats) {
  constexpr std::uint32_t kSide = 64;
  GridSpec spec;
  spec.box = {{0, 0, 0}, 1.0 / (kSide - 1), {kSide, kSide, kSide}};
  spec.model = "reference";
  spec.state_size = 9;
  const Neighbourhood neighbourhood(spec.box);
  RecordColumns columns;
  for (PointIndex p = 0; p < spec.box.points(); ++p) {
    columns.point.push_back(p);
    columns.level.push_back(0);
    // As from seeds in the corners.
    std::uint32_t generation = 0;
    for (const std::uint32_t at : spec.box.coordinates(p))
      generation = std::max(generation, std::min(at, kSide - 1 - at));
    columns.generation.push_back(generation);
    for (int c = 0; c < 9; ++c) {
      const double v = reference(c, spec.box.position(p));
      columns.rows.push_back(floats ? static_cast<float>(v) : v);
    }
    for (int q = 0; q < kDirections; ++q)
      columns.links.push_back(neighbourhood.inside(p) >> q & 1 ? Level{0} : kLeavesBox);
  }
  return Grid(spec, kSide / 2, std::move(columns));
}

/// CPU time: other work on the machine counts less.
double seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Answers the last sections written.
std::vector<Section> measure(const char* name, const Grid& grid, const char* coded_name,
                             const Coding& coding) {
  constexpr int kRepeat = 5;
  const double content = static_cast<double>(grid.records()) *
                         static_cast<double>(record_bytes(grid.spec().row_size()));
  std::vector<Section> sections;
  double bytes = 0, encode = 1e9, decode = 1e9;
  for (int repeat = 0; repeat < kRepeat; ++repeat) {
    FileDescriptor fd = unlinked_file(".");
    const double start = seconds();
    SectionWriter out(fd.get(), "bench", {Content::kGrid, grid.generation(), grid.spec(), coding});
    for (RecordIndex r = 0; r < grid.records(); ++r)
      out.record(grid.point(r), grid.level(r), grid.record_generation(r), grid.row(r).data(),
                 grid.links(r).data());
    out.finish();
    encode = std::min(encode, seconds() - start);
    sections = open_sections(std::make_shared<const InputFile>(std::move(fd), "bench"));
    bytes = static_cast<double>(sections[0].stored_bytes);
    const double begin = seconds();
    SectionReader reader(sections[0]);
    RecordRows rows;
    while (reader.next(rows)) continue;
    decode = std::min(decode, seconds() - begin);
  }
  std::printf("%-20s %-10s %8.3f bytes/record   encode %7.1f MB/s   decode %7.1f MB/s\n", name,
              coded_name, bytes / static_cast<double>(grid.records()), content / encode / 1e6,
              content / decode / 1e6);
  return sections;
}

void measure_all(const char* name, const Grid& grid) {
  const std::vector<Section> plain = measure(name, grid, "plain", {});
  measure(name, grid, "lossless", final_coding(plain, 0));
  measure(name, grid, "1e-4", final_coding(plain, 1e-4));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    measure_all("reference, floats", reference_grid(true));
    measure_all("reference, doubles", reference_grid(false));
  }
  for (int i = 1; i < argc; ++i) measure_all(argv[i], load_grid({argv[i]}).grid);
}
