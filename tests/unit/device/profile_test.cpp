#include "tools/devices/profile.hpp"

#include "libcore/base/file.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/device/place.hpp"

using namespace hapgrid;
using hapgrid::testing::place;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Profile shipped(const std::string& name) {
  const std::string file = std::string(HAPGRID_SOURCE_DIR "/examples/devices/") + name;
  return read_profile(read_text(file, 1 << 20), file);
}

/// A profile with these inputs, outputs and lines of [force].
Profile with(const std::string& input, const std::string& outputs, const std::string& force) {
  return read_profile(
      "name = \"d\"\nmatch = {vid = 1, pid = 2}\n"
      "workspace = {low = [-1, 0, 0], high = [1, 0, 0]}\n[input]\n" +
          input + outputs + "[force]\n" + force,
      "p");
}

HidReport teensy_report(std::initializer_list<std::uint8_t> bytes) {
  HidReport report(bytes);
  report.resize(65);
  return report;
}

}  // namespace

TEST_CASE("a Teensy with three axes") {
  const Profile teensy = shipped("teensy-rawhid.toml");
  CHECK(teensy.input_id == 0);
  CHECK(teensy.max_force == 3);
  CHECK(teensy.high == Vec3{0.08, 0.08, 0.08});
  CHECK(teensy.timing.keep_alive == 0.02);

  // 0x01020304 nm, -1 nm, 80,000,000 nm = 0x04C4B400.
  HidReport in =
      teensy_report({0, 0x48, 0x01, 0, 0, 4, 3, 2, 1, 0xff, 0xff, 0xff, 0xff, 0, 0xb4, 0xc4, 4});
  hapgrid_device_state input{};
  REQUIRE(teensy.decode(in, input));
  CHECK(input.position[0] == Approx(16909060e-9).epsilon(1e-15));
  CHECK(input.position[1] == Approx(-1e-9).epsilon(1e-15));
  CHECK(input.position[2] == Approx(0.08).epsilon(1e-15));
  CHECK(input.flags == HAPGRID_DEVICE_CLUTCH);
  in[2] = 0xfe;
  REQUIRE(teensy.decode(in, input));
  CHECK(input.flags == 0);
  const hapgrid_device_state before = input;
  in[5] = 9;
  CHECK_FALSE(teensy.decode(std::span(in).first(64), input));
  in[0] = 1;
  CHECK_FALSE(teensy.decode(in, input));
  CHECK_FALSE(teensy.decode({}, input));
  CHECK(place(input) == place(before));

  // 0.5 N is 500 = 0x01F4, -1.2349 N is -1234 = 0xFB2E, 2.0019 N is 2001 (towards zero).
  std::vector<HidReport> out;
  out = teensy.encode({0.5, -1.2349, 2.0019});
  CHECK(out ==
        std::vector<HidReport>{teensy_report({0, 0x48, 1, 0xf4, 0x01, 0x2e, 0xfb, 0xd1, 0x07})});
  const HidReport zero = teensy_report({0, 0x48, 1});
  CHECK(teensy.stop_reports() == std::vector<HidReport>{zero, teensy_report({0, 0x48, 0})});
  // 5000 = 0x1388: never beyond, never round the corner.
  out = teensy.encode({1e300, -40, 32.768});
  CHECK(out.front() == teensy_report({0, 0x48, 1, 0x88, 0x13, 0x78, 0xec, 0x88, 0x13}));
  out = teensy.encode({1, std::nan(""), 1});
  CHECK(out.front() == zero);
  out = teensy.encode({kInfinity, 0, 0});
  CHECK(out.front() == zero);
}

TEST_CASE("the template has every key") {
  const Profile device = shipped("template.toml");
  CHECK(device.input_id == 1);
  REQUIRE(device.init.size() == 2);
  CHECK(device.init[0].is_feature);
  CHECK(device.init[0].report == HidReport{5, 1});
  CHECK_FALSE(device.init[1].is_feature);
  CHECK(device.init[1].report == HidReport{3, 0xff});
  HidReport in(17);
  in[0] = 1;
  in[6] = 0xfe;
  in[7] = 0xff;
  hapgrid_device_state input{};
  REQUIRE(device.decode(in, input));
  CHECK(place(input) == Vec3{0, 0, -2 * 1e-6});
  CHECK(device.keep_alive == std::vector<HidReport>{{3, 1}});
}

TEST_CASE("each axis can have a report of its own") {
  const Profile board(with(R"(id = 1
length = 4
axes = [[1, 0, 0], [0, -1, 0], [0, 0, 1]]
x = {bit = 0, bits = 16, scale = 1.5e-6}
y = {bit = 16, bits = 16, scale = 1.5e-6}
)",
                           R"([[output]]
id = 5
length = 3
fixed = [{byte = 0, hex = "01"}]
x = {bit = 8, bits = 16, newtons_per_count = 6.2e-5, low = -32767, high = 32767}
[[output]]
id = 5
length = 3
fixed = [{byte = 0, hex = "02"}]
y = {bit = 8, bits = 16, newtons_per_count = 6.2e-5, low = -32767, high = 32767}
)",
                           R"(max = 2
axes = [[1, 0, 0], [0, -1, 0], [0, 0, 1]]
[reports]
stop = ["0c 04"]
)"));
  // 1 N is 16129 counts = 0x3F01.
  std::vector<HidReport> out;
  out = board.encode({1, 1, 7});
  CHECK(out == std::vector<HidReport>{{5, 1, 0x01, 0x3f}, {5, 2, 0xff, 0xc0}});
  CHECK(board.stop_reports() == std::vector<HidReport>{{5, 1, 0, 0}, {5, 2, 0, 0}, {0x0c, 4}});
  hapgrid_device_state input{};
  REQUIRE(board.decode(HidReport{1, 0xff, 0x7f, 0x00, 0x80}, input));
  CHECK(input.position[0] == Approx(32767 * 1.5e-6));
  CHECK(input.position[1] == Approx(32768 * 1.5e-6));
  CHECK(input.position[2] == 0);
}

TEST_CASE("fields of any place and order keep their values, and their neighbours") {
  std::mt19937 random(1);
  for (int round = 0; round < 2000; ++round) {
    BitField f;
    f.big_endian = random() % 2;
    f.is_signed = random() % 2;
    f.bits = f.big_endian ? 8 * (1 + random() % 4) : 1 + random() % 32;
    f.bit = f.big_endian ? 8 * (random() % 5) : random() % 33;
    std::vector<std::uint8_t> data(8);
    for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
    const std::vector<std::uint8_t> before = data;
    const std::int64_t value =
        f.least() +
        static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(f.most() - f.least() + 1));
    f.set(data, value);
    REQUIRE(f.get(data) == value);
    for (std::size_t i = 0; i < 64; ++i)
      if (i < f.bit || i >= f.bit + f.bits)
        REQUIRE((data[i / 8] >> i % 8 & 1) == (before[i / 8] >> i % 8 & 1));
  }
  // Literal bytes, big-endian.
  const BitField big{.bit = 8, .bits = 24, .is_signed = true, .big_endian = true};
  std::vector<std::uint8_t> data{9, 0xff, 0xfe, 0xfd, 9};
  CHECK(big.get(data) == -259);
  big.set(data, 0x123456);
  CHECK(data == std::vector<std::uint8_t>{9, 0x12, 0x34, 0x56, 9});
}

TEST_CASE("axes are turned, offset and inverted") {
  const Profile device(with(R"(id = 7
length = 3
axes = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
x = {bit = 0, bits = 8, signed = false, scale = 0.001, offset = -0.1}
y = {bit = 8, bits = 8, scale = -0.001}
clutch = {bit = 16, inverted = true}
next = {bit = 17}
)",
                            R"([[output]]
id = 8
length = 2
x = {bit = 0, bits = 8, signed = false, newtons_per_count = -0.02, zero = 128, low = 28, high = 228}
)",
                            "max = 2\naxes = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]\n"));
  hapgrid_device_state input{};
  const HidReport in{7, 200, 0x80, 0};
  REQUIRE(device.decode(in, input));
  hapgrid_device_state pressed{};
  REQUIRE(device.decode(HidReport{7, 200, 0x80, 3}, pressed));
  CHECK(pressed.flags == HAPGRID_DEVICE_NEXT);
  CHECK(input.position[0] == Approx(-0.128));
  CHECK(input.position[1] == Approx(0.1));
  CHECK(input.flags == HAPGRID_DEVICE_CLUTCH);
  std::vector<HidReport> out;
  out = device.encode({5, 1, 5});
  CHECK(out == std::vector<HidReport>{{8, 128 - 50, 0}});
  out = device.encode({0, -9, 0});
  CHECK(out == std::vector<HidReport>{{8, 228, 0}});
  CHECK(device.stop_reports() == std::vector<HidReport>{{8, 128, 0}});
}

TEST_CASE("no rounding makes a force larger") {
  // The rows keep lengths only within the tolerance: the first is 1.0004 long.
  const Profile device(with("length = 1\nx = {bit = 0, bits = 8, scale = 0.001}\n", R"([[output]]
length = 3
x = {bit = 0, bits = 8, newtons_per_count = 0.5}
y = {bit = 8, bits = 8, newtons_per_count = -0.5, zero = -20}
z = {bit = 16, bits = 8, signed = false, newtons_per_count = 0.03, zero = 128}
)",
                            "max = 3\naxes = [[0.6003, 0.8003, 0], [-0.8, 0.6, 0], [0, 0, 1]]\n"));
  std::vector<HidReport> out;
  const auto felt = [&](const Vec3& force) {
    out = device.encode(force);
    const std::vector<std::uint8_t>& r = out.front();
    return Vec3{0.5 * static_cast<std::int8_t>(r[1]), -0.5 * (static_cast<std::int8_t>(r[2]) + 20),
                0.03 * (r[3] - 128)};
  };
  // 2.99 N, on the outputs' axes (2.75, -0.75, -0.9), which the nearest counts make 3.29 N.
  CHECK(length_of(felt({2.25, 1.75, -0.9})) <= 2.99);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 10'000; ++i) {
    const Vec3 direction{normal(random), normal(random), normal(random)};
    const double newtons = 3.0 * (i % 100 + 1) / 100;
    const double given = length_of(felt(newtons / length_of(direction) * direction));
    REQUIRE(given <= newtons * (1 + 1e-12));
    // And less than a count is lost on each axis: 0.5 N twice, and 0.03 N; 0.15 % by the rows.
    REQUIRE(given >= newtons * (1 - 1.5e-3) - std::hypot(0.5, 0.5, 0.03));
  }
}

TEST_CASE("a profile without an output has no force") {
  const Profile mouse = read_profile(R"(name = "d"
match = {vid = 1, pid = 2}
input = {length = 4, x = {bit = 0, bits = 16, scale = 0.001}}
workspace = {low = [-1, 0, 0], high = [1, 0, 0]}
)",
                                     "p");
  CHECK(mouse.stop_reports().empty());
}
