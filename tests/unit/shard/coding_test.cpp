// Coded chunks: what comes back, how far it may be off, and what hostile ones do.
#include "libcore/shard/coding.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>

#include "libcore/base/error.hpp"
#include "libcore/shard/planes.hpp"
#include "tests/unit/shard/coding_reference.hpp"
#include "tests/unit/shard/rows.hpp"

using namespace hapgrid;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

SectionHeader coded_header(std::uint32_t n, GridCoordinates counts) {
  SectionHeader header;
  header.generation = 9;
  header.spec.box = {{0, 0, 0}, 1, counts};
  header.spec.model = "any";
  header.spec.state_size = n;
  header.coding.is_coded = true;
  return header;
}

/// Rows of a chunk in memory of their own.
struct Rows {
  std::vector<PointIndex> point;
  std::vector<Level> level;
  std::vector<std::uint32_t> generation;
  std::vector<Level> links;
  std::vector<double> numbers;
  std::size_t width = 1;

  RecordRows view() const {
    RecordRows rows;
    rows.point = point;
    rows.level = level;
    rows.generation = generation;
    rows.links = links;
    rows.numbers = numbers;
    rows.width = width;
    return rows;
  }
};

/// One level at each point of a box, all linked; numbers by value(coordinates, column).
template <class Value>
Rows dense_rows(const SectionHeader& header, Value&& value) {
  const Box& box = header.spec.box;
  const Neighbourhood neighbourhood(box);
  Rows rows;
  rows.width = row_size(header);
  for (PointIndex p = 0; p < box.points(); ++p) {
    rows.point.push_back(p);
    rows.level.push_back(0);
    rows.generation.push_back(p % 7);
    for (int q = 0; q < kDirections; ++q)
      rows.links.push_back(neighbourhood.inside(p) >> q & 1 ? Level{0} : kLeavesBox);
    for (std::size_t c = 0; c < rows.width; ++c)
      rows.numbers.push_back(value(box.coordinates(p), c));
  }
  return rows;
}

/// Some levels at some points with links to anywhere, or as many at all points, each linked to its
/// like; numbers of all kinds.
Rows random_rows(Random& random, const SectionHeader& header) {
  static constexpr double kSpecial[] = {0.0,     -0.0,      1e-310,     -1e308,
                                        1.7e308, kInfinity, -kInfinity, 4e-320};
  const std::uint32_t kind = draw(random, 0, 4);
  const std::uint32_t most_levels = draw(random, 1, 4);
  const bool alike = draw(random, 0, 3) == 0;
  Rows rows;
  rows.width = row_size(header);
  for (PointIndex p = 0; p < header.spec.box.points(); ++p) {
    const std::uint32_t levels = alike ? most_levels : draw(random, p == 0, most_levels);
    for (std::uint32_t l = 0; l < levels; ++l) {
      rows.point.push_back(p);
      rows.level.push_back(static_cast<Level>(l));
      rows.generation.push_back(static_cast<std::uint32_t>(kind == 0 ? random() : p % 9));
      for (int q = 0; q < kDirections; ++q)
        rows.links.push_back(static_cast<Level>(alike                ? l
                                                : random() % 16 == 0 ? random()
                                                                     : random() % levels));
      for (std::size_t c = 0; c < rows.width; ++c) {
        const double smooth = std::sin(0.01 * p + static_cast<double>(c)) + l;
        const std::uint64_t bits = random();
        double v = kind == 1   ? static_cast<float>(smooth)
                   : kind == 2 ? std::bit_cast<double>(bits)  // anything, NaN of all kinds too
                   : kind == 3 ? std::floor(100 * smooth)
                               : smooth;
        if (kind != 3 && random() % 64 == 0) v = kSpecial[random() % std::size(kSpecial)];
        rows.numbers.push_back(v);
      }
    }
  }
  return rows;
}

CodedChunk<std::span<const std::uint8_t>> view(const CodedChunk<std::vector<std::uint8_t>>& coded) {
  return {coded.rows,  coded.point, coded.level,  coded.links,     coded.generation,
          coded.order, coded.shift, coded.planes, coded.residuals, coded.first};
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

template <class A, class B>
bool equal(const A& a, const B& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

}  // namespace

TEST_CASE("coded rows come back bit by bit") {
  Random random(2101);
  for (int i = 0; i < 300; ++i) {
    CAPTURE(i);
    // Many columns now and then: they are coded some at a time.
    const SectionHeader header =
        coded_header(draw(random, 1, i % 10 == 0 ? 40 : 5),
                     {draw(random, 1, 12), draw(random, 1, 9), draw(random, 1, 9)});
    ChunkEncoder encoder(header);
    ChunkDecoder decoder(header);
    const Rows rows = random_rows(random, header);
    RecordRows back;
    decoder.decode(view(encoder.encode(rows.view())), back);
    REQUIRE(equal(back.point, rows.point));
    REQUIRE(equal(back.level, rows.level));
    REQUIRE(equal(back.generation, rows.generation));
    REQUIRE(equal(back.links, rows.links));
    REQUIRE(std::equal(back.numbers.begin(), back.numbers.end(), rows.numbers.begin(),
                       rows.numbers.end(), same_bits));
  }
}

TEST_CASE("no number is off by more than its bound") {
  Random random(2102);
  int exact = 0, moved = 0;
  for (int i = 0; i < 300; ++i) {
    CAPTURE(i);
    SectionHeader header =
        coded_header(3, {draw(random, 1, 12), draw(random, 1, 9), draw(random, 1, 9)});
    header.coding.precision = 0.01;
    header.coding.bounds = {0, 1e-3, std::pow(10.0, -static_cast<int>(draw(random, 0, 320)))};
    ChunkEncoder encoder(header);
    ChunkDecoder decoder(header);
    const Rows rows = random_rows(random, header);
    RecordRows back;
    decoder.decode(view(encoder.encode(rows.view())), back);
    REQUIRE(equal(back.links, rows.links));
    for (std::size_t at = 0; at < rows.numbers.size(); ++at) {
      const double bound = header.coding.bounds[at % 3];
      const bool same = same_bits(back.numbers[at], rows.numbers[at]);
      REQUIRE((same || (bound > 0 && std::abs(back.numbers[at] - rows.numbers[at]) <= bound)));
      ++(same ? exact : moved);
    }
  }
  REQUIRE(exact > 1000);
  REQUIRE(moved > 1000);
}

TEST_CASE("numbers are decoded as schemas/CODING.md says") {
  Random random(2105);
  int steps = 0, doubles = 0;
  for (int i = 0; i < 200; ++i) {
    CAPTURE(i);
    const bool lossy = i % 2 == 1;
    SectionHeader header =
        coded_header(draw(random, 1, i % 10 < 2 ? 20 : 5),
                     {draw(random, 1, 12), draw(random, 1, 9), draw(random, 1, 9)});
    if (lossy) header.coding.precision = 0.01;
    for (std::uint32_t c = 0; lossy && c < header.spec.state_size; ++c)
      header.coding.bounds.push_back(c % 3 == 0 ? 0 : c % 3 == 1 ? 1e-3 : 1e-6);
    ChunkEncoder encoder(header);
    ChunkDecoder decoder(header);
    const Rows rows = random_rows(random, header);
    CodedChunk<std::vector<std::uint8_t>> coded = encoder.encode(rows.view());
    // As it was coded, and with other orders, shifts, residuals and first values.
    if (i % 4 >= 2) {
      for (std::uint8_t& order : coded.order) order = static_cast<std::uint8_t>(random() % 64);
      for (std::uint8_t& shift : coded.shift)
        if (shift != kSteps) shift = static_cast<std::uint8_t>(random() % 53);
      for (std::uint8_t& byte : coded.residuals)
        if (random() % 8 == 0) byte = static_cast<std::uint8_t>(random());
      for (std::uint8_t& byte : coded.first)
        if (random() % 8 == 0) byte = static_cast<std::uint8_t>(random());
    }
    RecordRows back;
    decoder.decode(view(coded), back);

    std::vector<reference::Row> links;
    for (std::size_t r = 0; r < rows.point.size(); ++r) {
      const Level* const link = &rows.links[r * kDirections];
      links.push_back({rows.point[r], rows.level[r], {link[12], link[10], link[4]}});
    }
    const GridCoordinates& n = header.spec.box.counts;
    const std::vector<reference::Way> ways = reference::ways(links, {n[0], n[1], n[2]});
    std::size_t at = 0;
    for (std::size_t c = 0; c < rows.width; ++c) {
      std::vector<std::uint64_t> residuals(links.size());
      for (unsigned plane = 0; plane < coded.planes[c]; ++plane)
        for (std::uint64_t& z : residuals) z |= std::uint64_t{coded.residuals[at++]} << 8 * plane;
      ++(coded.shift[c] == kSteps ? steps : doubles);
      std::uint64_t first = 0;
      for (std::size_t b = 0; b < 8; ++b) first |= std::uint64_t{coded.first[8 * c + b]} << 8 * b;
      const std::vector<double> expected =
          coded.shift[c] == kSteps
              ? reference::decode_integers(ways, coded.order[c], header.coding.bounds[c], first,
                                           residuals)
              : reference::decode_doubles(ways, coded.order[c], coded.shift[c],
                                          std::bit_cast<double>(first), residuals);
      for (std::size_t r = 0; r < links.size(); ++r) {
        CAPTURE(c, r);
        if (!same_bits(back.numbers[r * rows.width + c], expected[r]))
          FAIL("not what the page says");
      }
    }
    REQUIRE(at == coded.residuals.size());
  }
  REQUIRE(steps > 50);
  REQUIRE(doubles > 500);
}

TEST_CASE("in a box the way back is as long as the way to its sides") {
  const SectionHeader header = coded_header(1, {7, 6, 5});
  const Rows rows = dense_rows(header, [](const GridCoordinates&, std::size_t) { return 0; });
  Stencil stencil;
  stencil.find(rows.point, rows.level, rows.links, header.spec.box.counts);
  const std::uint32_t strides[3] = {1, 7, 42};
  for (std::uint32_t r = 0; r < rows.point.size(); ++r)
    for (std::size_t a = 0; a < 3; ++a) {
      const std::uint32_t at = header.spec.box.coordinates(r)[a];
      REQUIRE(stencil.axes[a].depth[r] == std::min(3u, at));
      if (at > 0) REQUIRE(stencil.axes[a].back[r] == r - strides[a]);
    }
}

TEST_CASE("the way back follows links, not levels") {
  // Two points with two branches that have changed their numbers between them.
  std::vector<PointIndex> point{0, 0, 1, 1};
  std::vector<Level> level{0, 1, 0, 1};
  std::vector<Level> links(4 * kDirections, kLeavesBox);
  constexpr std::size_t kBack = 12;
  links[2 * kDirections + kBack] = 1;
  links[3 * kDirections + kBack] = 0;
  Stencil stencil;
  stencil.find(point, level, links, {2, 1, 1});
  REQUIRE(stencil.axes[0].depth == std::vector<std::uint8_t>{0, 0, 1, 1});
  REQUIRE(stencil.axes[0].back[2] == 1);
  REQUIRE(stencil.axes[0].back[3] == 0);
  REQUIRE(stencil.fallback == std::vector<std::uint32_t>{0, 0, 1, 0});
}

TEST_CASE("polynomials are predicted exactly where there are rows enough") {
  // Of the degree 2 along each axis, with values that doubles hold exactly: order 3 leaves nothing.
  const SectionHeader header = coded_header(1, {9, 8, 7});
  const Rows rows = dense_rows(header, [](const GridCoordinates& at, std::size_t) {
    const double x = at[0], y = at[1], z = at[2];
    return (1 + 2 * x - x * x) * (3 - y + 0.5 * y * y) * (2 + z + 0.25 * z * z);
  });
  Stencil stencil;
  stencil.find(rows.point, rows.level, rows.links, header.spec.box.counts);
  Predictor<double> predictor;
  std::vector<std::uint64_t> values;
  for (const double v : rows.numbers) values.push_back(std::bit_cast<std::uint64_t>(v));
  const auto residuals_with = [&](const Orders& orders) {
    std::vector<std::uint64_t> numbers = values;
    const PredictedColumn column{orders, 0, numbers[0], numbers.data()};
    predictor.begin(stencil, std::span(&column, 1));
    predictor.encode(numbers.size());
    return numbers;
  };
  for (const Orders orders : {Orders{3, 0, 0}, Orders{0, 3, 0}, Orders{0, 0, 3}, Orders{3, 3, 3},
                              Orders{1, 3, 2}, Orders{2, 2, 2}}) {
    CAPTURE(int(orders.i), int(orders.j), int(orders.k));
    const std::vector<std::uint64_t> residuals = residuals_with(orders);
    std::size_t left = 0;
    for (PointIndex p = 0; p < rows.point.size(); ++p) {
      const GridCoordinates at = header.spec.box.coordinates(p);
      const bool enough = (orders.i == 3 && at[0] >= 3) || (orders.j == 3 && at[1] >= 3) ||
                          (orders.k == 3 && at[2] >= 3);
      if (enough) REQUIRE(residuals[p] == 0);
      left += residuals[p] != 0;
    }
    REQUIRE(left > 0);
  }
  // Which the encoder finds: of 504 values few are left.
  const auto residuals = residuals_with(choose_orders_of_doubles(stencil, 0, values));
  REQUIRE(std::count(residuals.begin(), residuals.end(), 0u) > 300);
}

TEST_CASE("columns whose values are floats take a float's bits alone") {
  const SectionHeader header = coded_header(2, {20, 20, 20});
  const Rows rows = dense_rows(header, [](const GridCoordinates& at, std::size_t c) {
    const double v = 3 + std::sin(0.1 * at[0] + std::cos(0.17 * at[1]) + 0.13 * at[2]);
    return c == 0 ? static_cast<float>(v) : v;
  });
  ChunkEncoder encoder(header);
  const auto& coded = encoder.encode(rows.view());
  REQUIRE(coded.shift[0] >= 29);
  REQUIRE(coded.shift[1] == 0);
  REQUIRE(coded.planes[0] <= 3);
  REQUIRE(coded.planes[1] >= coded.planes[0] + 3);
}

TEST_CASE("planes are the bytes of numbers") {
  const std::vector<std::uint32_t> values{0x01020304, 0x05, 0xfedcba98};
  std::vector<std::uint8_t> bytes(12);
  split_planes<std::uint32_t>(values, 4, bytes.data());
  REQUIRE(bytes == std::vector<std::uint8_t>{4, 5, 0x98, 3, 0, 0xba, 2, 0, 0xdc, 1, 0, 0xfe});
  std::vector<std::uint32_t> back(3, 99);
  join_planes<std::uint32_t>(bytes.data(), 3, 4, back);
  REQUIRE(back == values);
  REQUIRE(planes_needed<std::uint32_t>(values) == 4);
  REQUIRE(planes_needed<std::uint32_t>(std::vector<std::uint32_t>{0, 0}) == 0);
  REQUIRE(planes_needed<std::uint32_t>(std::vector<std::uint32_t>{255, 0}) == 1);
  REQUIRE(planes_needed<std::uint32_t>(std::vector<std::uint32_t>{256, 0}) == 2);
}

TEST_CASE("a shape that floats cannot hold is refused") {
  SectionHeader header = coded_header(1, {2, 1, 1});
  header.spec.stored.shape = true;
  header.spec.spheres.resize(1);
  for (const double v : {3.4e38, 3.5e38}) {
    const Rows rows =
        dense_rows(header, [v](const GridCoordinates&, std::size_t c) { return c == 2 ? v : 0; });
    ChunkEncoder encoder(header);
    ChunkDecoder decoder(header);
    RecordRows back;
    const auto coded = view(encoder.encode(rows.view()));
    if (v < 3.45e38)
      REQUIRE_NOTHROW(decoder.decode(coded, back));
    else
      REQUIRE_THROWS_AS(decoder.decode(coded, back), FormatError);
  }
}

TEST_CASE("hostile coded chunks are refused or decoded, whatever they hold") {
  Random random(2104);
  int refused = 0, decoded = 0;
  for (int i = 0; i < 20000; ++i) {
    SectionHeader header =
        coded_header(draw(random, 1, 3), {draw(random, 1, 4), draw(random, 1, 4), 3});
    if (i % 3 == 0) {
      header.coding.precision = 0.1;
      for (std::uint32_t c = 0; c < header.spec.state_size; ++c)
        header.coding.bounds.push_back(c == 0 ? 1e300 : 1e-3);
    }
    ChunkEncoder encoder(header);
    ChunkDecoder decoder(header);
    CodedChunk<std::vector<std::uint8_t>> coded =
        encoder.encode(random_rows(random, header).view());
    std::vector<std::uint8_t>* const columns[] = {
        &coded.point, &coded.level,  &coded.links,     &coded.generation, &coded.order,
        &coded.shift, &coded.planes, &coded.residuals, &coded.first};
    for (std::uint32_t change = draw(random, 1, 3); change > 0; --change) {
      std::vector<std::uint8_t>& column = *columns[random() % 9];
      switch (random() % 8) {
        case 0:
          column.resize(random() % (column.size() + 9));
          break;
        case 1:
          coded.rows = static_cast<std::uint32_t>(random() >> draw(random, 32, 63));
          break;
        case 2:
          for (std::uint8_t& byte : column) byte = static_cast<std::uint8_t>(random());
          break;
        default:
          if (!column.empty())
            column[random() % column.size()] ^= static_cast<std::uint8_t>(random());
      }
    }
    RecordRows back;
    try {
      decoder.decode(view(coded), back);
      ++decoded;
      REQUIRE(back.numbers.size() == coded.rows * std::size_t{header.spec.state_size});
      // Whatever it was, it can be coded again; with other residuals perhaps.
      RecordRows again;
      decoder.decode(view(encoder.encode(back)), again);
      REQUIRE(equal(again.point, back.point));
      if (!header.coding.is_lossy())
        REQUIRE(std::equal(again.numbers.begin(), again.numbers.end(), back.numbers.begin(),
                           back.numbers.end(), same_bits));
    } catch (const FormatError&) {
      ++refused;
    }
  }
  REQUIRE(refused > 1000);
  REQUIRE(decoded > 1000);
}
