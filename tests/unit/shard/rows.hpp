// Random rows of every content, and sections of them, for tests of shards and of what reads them.
#pragma once

#include <fcntl.h>

#include "libcore/shard/writer.hpp"
#include "tests/unit/catch.hpp"

namespace hapgrid {

using Random = std::mt19937_64;

inline std::uint32_t draw(Random& random, std::uint32_t least, std::uint32_t most) {
  return std::uniform_int_distribution<std::uint32_t>(least, most)(random);
}

inline GridSpec make_spec(std::uint32_t n, GridCoordinates counts) {
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
inline GridSpec storing(GridSpec spec) {
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

inline std::vector<double> random_state(Random& random, std::uint32_t n) {
  static constexpr double kSpecial[] = {0.0, -0.0, 1e-310, std::numeric_limits<double>::max()};
  std::vector<double> state(n);
  for (double& c : state)
    c = random() % 8 == 0 ? kSpecial[random() % 4] : static_cast<double>(random()) * 1e-18 - 9;
  return state;
}

/// The numbers of a row; those of a stored shape are floats.
inline std::vector<double> random_row(Random& random, const SectionHeader& header) {
  std::vector<double> row = random_state(random, header.spec.row_size());
  for (std::size_t i = header.spec.shape_offset(); i < row.size(); ++i)
    row[i] = static_cast<float>(std::clamp(row[i], -1e30, 1e30));
  return row;
}

/// Some rows in order.
inline std::vector<Row> random_rows(Random& random, const SectionHeader& header,
                                    std::size_t wanted) {
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
  for (auto& [key, row] : rows) sorted.push_back(std::move(row));
  return sorted;
}

/// What was reached, in its places among 26.
inline std::vector<double> spread(const Row& row, std::uint32_t width) {
  std::vector<double> rows(std::size_t{kDirections} * width, std::nan(""));
  auto from = row.state.begin();
  for (int q = 0; q < kDirections; ++q)
    if (row.directions >> q & 1)
      for (std::uint32_t c = 0; c < width; ++c)
        rows[static_cast<std::size_t>(q) * width + c] = *from++;
  return rows;
}

/// Appends a section to a file.
inline void write(const std::string& name, const SectionHeader& header,
                  const std::vector<Row>& rows, Packing packing = Packing::kFast) {
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

}  // namespace hapgrid
