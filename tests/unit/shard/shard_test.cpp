// What is written comes back, row by row, whatever its chunks are.

#include <fcntl.h>

#include "libcore/shard/reader.hpp"
#include "libcore/shard/writer.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/temporary_directory.hpp"

using namespace hapgrid;

namespace {

using Random = std::mt19937_64;

std::uint32_t draw(Random& random, std::uint32_t least, std::uint32_t most) {
  return std::uniform_int_distribution<std::uint32_t>(least, most)(random);
}

GridSpec make_spec(std::uint32_t n, GridCoordinates counts) {
  GridSpec spec;
  spec.box = {{-1.5, 0.1, 1e-300}, 0.1, counts};
  spec.model = "some-model_2";
  spec.parameters = {{"flag", true},
                     {"number", -0.1},
                     {"numbers", std::vector<double>{1, 2.5, 1e308}},
                     {"text", std::string("x\n\xff\xc3\xa9 \"")},
                     {"texts", std::vector<std::string>{"", "a", "b"}}};
  spec.state_size = n;
  spec.tolerance = 1e-7;
  spec.tolerance_unit = "rad";
  spec.max_levels = 254;
  return spec;
}

/// The same grid, with everything stored beside its states.
GridSpec storing(GridSpec spec) {
  spec.stored = {true, true, true};
  spec.spheres = {{0.5F, {0, 0.25F, 1}, "C"}, {1e-3F, {1, 1, 1}, ""}, {2, {0, 0, 0}, "1234567"}};
  return spec;
}

/// Any row of any content; what does not belong to the content stays empty.
struct Row {
  PointIndex point = 0;
  Level level = 0;
  std::uint32_t generation = 0;
  std::vector<double> state;  // of requests, of one after the other
  std::vector<Level> links;
  DirectionMask directions = 0;  // of requests

  friend bool operator==(const Row&, const Row&) = default;
};

std::vector<double> random_state(Random& random, std::uint32_t n) {
  static constexpr double kSpecial[] = {0.0, -0.0, 1e-310, std::numeric_limits<double>::max()};
  std::vector<double> state(n);
  for (double& c : state)
    c = random() % 8 == 0 ? kSpecial[random() % 4] : static_cast<double>(random()) * 1e-18 - 9;
  return state;
}

/// The numbers of a row; those of a stored shape are floats.
std::vector<double> random_row(Random& random, const SectionHeader& header) {
  std::vector<double> row = random_state(random, header.spec.row_size());
  for (std::size_t i = header.spec.shape_offset(); i < row.size(); ++i)
    row[i] = static_cast<float>(std::clamp(row[i], -1e30, 1e30));
  return row;
}

/// Some rows in order.
std::vector<Row> random_rows(Random& random, const SectionHeader& header, std::size_t wanted) {
  const Neighbourhood neighbourhood(header.spec.box);
  const auto last = static_cast<PointIndex>(header.spec.box.points() - 1);
  std::map<RowKey, Row> rows;
  for (std::size_t i = 0; i < wanted; ++i) {
    Row row;
    row.point = draw(random, 0, last);
    const DirectionMask inside = neighbourhood.inside(row.point);
    row.level = static_cast<Level>(draw(random, 0, 3));
    if (header.content == Content::kRequests) {
      row.directions = random() % 4 == 0 ? inside : inside & static_cast<DirectionMask>(random());
      if (!row.directions) continue;
      for (DirectionMask left = row.directions; left; left &= left - 1) {
        const std::vector<double> reached = random_row(random, header);
        row.state.insert(row.state.end(), reached.begin(), reached.end());
      }
    } else {
      row.generation = header.generation - draw(random, 0, header.generation);
      row.state = random_row(random, header);
      for (int q = 0; q < kDirections; ++q) row.links.push_back(static_cast<Level>(random()));
    }
    rows[record_key(row.point, row.level)] = row;
  }
  std::vector<Row> sorted;
  sorted.reserve(rows.size());
  for (auto& [key, row] : rows) sorted.push_back(std::move(row));
  return sorted;
}

/// What was reached, in its places among 26.
std::vector<double> spread(const Row& row, std::uint32_t width) {
  std::vector<double> rows(std::size_t{kDirections} * width, std::nan(""));
  auto from = row.state.begin();
  for (int q = 0; q < kDirections; ++q)
    if (row.directions >> q & 1)
      for (std::uint32_t c = 0; c < width; ++c)
        rows[static_cast<std::size_t>(q) * width + c] = *from++;
  return rows;
}

/// Appends a section to a file.
void write(const std::string& name, const SectionHeader& header, const std::vector<Row>& rows,
           Packing packing = Packing::kFast) {
  const FileDescriptor file(::open(name.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  REQUIRE(file);
  SectionWriter out(file.get(), name, header, packing);
  for (const Row& row : rows) {
    if (header.content == Content::kGrid)
      out.record(row.point, row.level, row.generation, row.state.data(), row.links.data());
    else
      out.requests(row.point, row.level, row.directions,
                   spread(row, header.spec.row_size()).data());
  }
  out.finish();
}

Row record_of(const Chunk& rows, std::size_t r, std::uint32_t n) {
  Row row{rows.point[r], rows.level[r], rows.generation[r], {}, {}, 0};
  row.state.assign(rows.row(r), rows.row(r) + n);
  row.links.assign(&rows.links[r * kDirections], &rows.links[r * kDirections] + kDirections);
  return row;
}
Row requests_of(const Chunk& rows, std::size_t r, std::uint32_t n) {
  Row row{rows.point[r], rows.level[r], 0, {}, {}, rows.directions[r]};
  const auto count = static_cast<std::size_t>(std::popcount(rows.directions[r]));
  row.state.assign(rows.row(rows.first[r]), rows.row(rows.first[r]) + count * n);
  return row;
}

std::vector<Row> read_rows(const Section& section) {
  const auto row_of = section.header.content == Content::kGrid ? record_of : requests_of;
  std::vector<Row> found;
  SectionReader reader(section);
  Chunk rows;
  for (std::size_t i = 0; i < section.chunks.size(); ++i) {
    reader.read(i, rows);
    for (std::size_t r = 0; r < rows.size(); ++r)
      found.push_back(row_of(rows, r, section.header.spec.row_size()));
  }
  return found;
}

std::string bytes_of(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  std::string bytes(std::filesystem::file_size(name), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return bytes;
}

}  // namespace

TEST_CASE("rows come back from a shard as they were") {
  Random random(2003);
  for (const Content content : {Content::kGrid, Content::kRequests}) {
    for (const std::uint32_t n : {1u, 2u, 1500u}) {
      // Nothing, one row, and several chunks.
      for (const std::size_t wanted :
           {std::size_t{0}, std::size_t{1}, n == 1500 ? std::size_t{150} : 6000}) {
        CAPTURE(to_string(content), n, wanted);
        const TemporaryDirectory dir;
        GridSpec spec = make_spec(n, {60, 50, 20});
        if (n == 2) spec = storing(spec);
        const SectionHeader header{content, 7, spec};
        const std::vector<Row> rows = random_rows(random, header, wanted);
        write(dir.file("shard"), header, rows);
        const auto sections = open_sections({dir.file("shard")});
        REQUIRE(sections.size() == 1);
        const Section& section = sections[0];
        REQUIRE(section.header.content == content);
        REQUIRE(section.header.generation == 7);
        REQUIRE(section.header.spec == header.spec);
        REQUIRE(section.begin == 0);
        REQUIRE(section.end == std::filesystem::file_size(dir.file("shard")));
        REQUIRE(section.records() == rows.size());
        if (content == Content::kRequests) {
          std::uint64_t requests = 0;
          for (const Row& row : rows) requests += row.state.size() / spec.row_size();
          REQUIRE(section.conversions() == requests);
        }
        const std::size_t chunks = section.chunks.size();
        REQUIRE((wanted > 1 ? chunks >= 2 : chunks == rows.size()));
        REQUIRE(read_rows(section) == rows);
        // The same rows are the same bytes.
        write(dir.file("again"), header, rows);
        REQUIRE(bytes_of(dir.file("shard")) == bytes_of(dir.file("again")));
      }
    }
  }
}

TEST_CASE("chunks of a grid stay below 64 KiB, or 1 MiB, and keep to their points") {
  Random random(2004);
  for (const Packing packing : {Packing::kFast, Packing::kSmall}) {
    const std::uint64_t most = packing == Packing::kFast ? 1 << 16 : 1 << 20;
    for (const std::uint32_t n : {1u, 9u, 1500u, 140000u}) {
      CAPTURE(n, most);
      const TemporaryDirectory dir;
      const SectionHeader header{
          Content::kGrid, 0,
          make_spec(n, n > 9 ? GridCoordinates{8, 8, 8} : GridCoordinates{40, 40, 40})};
      const std::vector<Row> rows = random_rows(random, header, n > 1500 ? 2 : n > 9 ? 150 : 8000);
      write(dir.file("shard"), header, rows, packing);
      const Section section = open_grid(dir.file("shard"));
      const std::uint32_t points = chunk_points(n, most);
      for (const ChunkInfo& chunk : section.chunks) {
        REQUIRE((chunk.rows == 1 || chunk.rows * record_bytes(n) <= most));
        REQUIRE(chunk.first_point / points == chunk.last_point / points);
      }
      REQUIRE(read_rows(section) == rows);
    }
  }
}
