#include "libcore/device/pid.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "libcore/base/error.hpp"
#include "tests/hid/descriptors.h"
#include "tests/unit/haptic/count_allocations.hpp"

using namespace hapgrid;
using Bytes = std::vector<std::uint8_t>;

namespace {

/// Writes down what goes out, and answers Block Load with blocks 1, 2, ...; what a device does with
/// it is tests/qemu's matter.
struct Channel : HidChannel {
  std::vector<Bytes> sent;
  Bytes answer;         // of Block Load; the index is counted up in it
  std::size_t asked{};  // bytes, the last time

  void write(std::span<const std::uint8_t> report) override {
    sent.emplace_back(report.begin(), report.end());
  }
  void set_feature(std::span<const std::uint8_t> report) override {
    sent.emplace_back(report.begin(), report.end());
    if (answer.size() > 1) ++answer[1];
  }
  HidReport get_feature(std::uint8_t id, std::size_t size) override {
    CHECK(id == answer[0]);
    asked = size;
    return answer;
  }
};

/// One device's ids, as notes and firmware give them.
struct Ids {
  HidDescriptor descriptor;
  std::uint8_t input, constant, operation, free, control, gain, create, load;
  std::uint8_t enable, stop, reset;  // of Device Control
  std::uint8_t set_effect;
  Bytes direction_x;
};

const Ids kOpenFfBoard{parse_hid_descriptor(kPidBits),
                       0x01,
                       0x05,
                       0x0a,
                       0x0b,
                       0x0c,
                       0x0d,
                       0x11,
                       0x12,
                       0x01,
                       0x04,
                       0x08,
                       0x01,
                       {0x28, 0x23}};  // 9000 of 36000
const Ids kArduino{parse_hid_descriptor(kPidArray),
                   0x03,
                   0x05,
                   0x0a,
                   0x0b,
                   0x0c,
                   0x0d,
                   0x05,
                   0x06,
                   0x01,
                   0x03,
                   0x04,
                   0x01,
                   {0x40}};  // 64 of 255
const Ids kRhino{parse_hid_descriptor(kPidHighIds),
                 0x01,
                 105,
                 110,
                 111,
                 112,
                 113,
                 0x05,
                 0x06,
                 0x01,
                 0x03,
                 0x04,
                 101,
                 {0x28, 0x23}};

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Bytes set_effect(const Ids& d, std::uint8_t block, const Bytes& direction) {
  return Bytes{d.set_effect, block, 0x01, 0xff, 0xff, 0, 0, 0, 0, 0, 0, 0xff, 0, 0x04} + direction +
         Bytes(d.direction_x.size());
}

Bytes without(const unsigned char* bytes, std::size_t size, Bytes what, const Bytes& instead) {
  Bytes all(bytes, bytes + size);
  const auto at = std::search(all.begin(), all.end(), what.begin(), what.end());
  REQUIRE(at != all.end());
  std::copy(instead.begin(), instead.end(), at);
  return all;
}

std::string refusal(const Bytes& descriptor) {
  try {
    PidProtocol(parse_hid_descriptor(descriptor), {});
  } catch (const DeviceError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("PID: the sequence, byte for byte, for three devices' ids") {
  const Ids& d = *GENERATE(&kOpenFfBoard, &kArduino, &kRhino);
  PidProtocol protocol(d.descriptor, {});
  Channel channel;
  channel.answer = {d.load, 0, 1, 0xff, 0x00};
  protocol.start(channel);
  CHECK(channel.asked == 5);  // id, index, status, 16 bits of room
  const Bytes zeros(d.direction_x.size());
  const std::vector<Bytes> expected{
      {d.control, d.reset},      {d.control, d.enable},           {d.gain, 0xff},
      {d.create, 0x01, 0, 0},    set_effect(d, 1, d.direction_x), {d.constant, 1, 0, 0},
      {d.operation, 1, 1, 0xff}, {d.create, 0x01, 0, 0},          set_effect(d, 2, zeros),
      {d.constant, 2, 0, 0},     {d.operation, 2, 1, 0xff},
  };
  CHECK(channel.sent == expected);
  CHECK(protocol.stop() == std::vector<Bytes>{{d.constant, 1, 0, 0},
                                              {d.constant, 2, 0, 0},
                                              {d.control, d.stop},
                                              {d.free, 1},
                                              {d.free, 2}});
}

TEST_CASE("PID: before the start there is only the stop") {
  PidProtocol protocol(kArduino.descriptor, {});
  CHECK(protocol.stop() == std::vector<Bytes>{{0x0c, 3}});
  std::vector<HidReport> reports;
  protocol.encode({1, 1, 1}, reports);
  CHECK(reports.empty());
}

TEST_CASE("PID: forces are shares of the largest magnitude") {
  PidProtocol protocol(kArduino.descriptor, {.newtons = 4, .signs = {1, 1}});
  Channel channel;
  channel.answer = {6, 4, 1, 0, 0};
  protocol.start(channel);
  std::vector<HidReport> reports;
  const auto sent = [&](const Vec3& force) {
    protocol.encode(force, reports);
    return reports;
  };
  using Reports = std::vector<HidReport>;
  // 1 N of 4 is 2500 = 0x09c4 of 10000; 2 N away from the user, in HID's y -2, are -5000 = 0xec78.
  CHECK(sent({1, 2, 7}) == Reports{{5, 5, 0xc4, 0x09}, {5, 6, 0x78, 0xec}});
  CHECK(sent({0, 0, 0}) == Reports{{5, 5, 0, 0}, {5, 6, 0, 0}});
  // Towards zero: 2500.9 and -5000.9.
  CHECK(sent({1.00036, 2.00036, 0}) == Reports{{5, 5, 0xc4, 0x09}, {5, 6, 0x78, 0xec}});
  // Saturated: 10000 = 0x2710, -10000 = 0xd8f0.
  CHECK(sent({1e300, 4.001, 0}) == Reports{{5, 5, 0x10, 0x27}, {5, 6, 0xf0, 0xd8}});
  const double inf = std::numeric_limits<double>::infinity();
  CHECK(sent({-inf, std::nan(""), 0}) == Reports{{5, 5, 0, 0}, {5, 6, 0, 0}});
  const std::size_t before = testing::allocations();
  protocol.encode({1, 2, 3}, reports);
  CHECK(testing::allocations() == before);

  // By DirectInput's rule a force to the right comes from the left, and one away from the user from
  // the user.
  PidProtocol usual(kRhino.descriptor, {.newtons = 1});
  channel.answer = {6, 0, 1, 0, 0};
  usual.start(channel);
  usual.encode({1, 1, 0}, reports);
  CHECK(reports == Reports{{105, 1, 0x00, 0xf0}, {105, 2, 0x00, 0xf0}});  // -4096
}

TEST_CASE("PID: positions in metres") {
  PidProtocol protocol(kArduino.descriptor, {.half_range = 0.03});
  DeviceInput input;
  input.clutch = true;
  CHECK(protocol.decode(Bytes{3, 0, 0xff, 0x7f, 0x01, 0x80}, input));  // 32767, -32767
  CHECK(input.position[0] == Approx(0.03).epsilon(1e-15));
  CHECK(input.position[1] == Approx(0.03).epsilon(1e-15));  // away from the user
  CHECK(input.position[2] == 0);
  CHECK(input.clutch);
  CHECK(protocol.decode(Bytes{3, 0xff, 0, 0, 0, 0x40}, input));  // 16384 of 32767
  CHECK(input.position[0] == 0);
  CHECK(input.position[1] == Approx(-0.03 * 16384 / 32767).epsilon(1e-15));
  // The first of its eight buttons.
  CHECK(input.reset);
  CHECK(protocol.decode(Bytes{3, 0xfe, 0, 0, 0, 0x40}, input));
  CHECK_FALSE(input.reset);
  const Vec3 last = input.position;
  CHECK_FALSE(protocol.decode(Bytes{2, 0, 1, 0, 1, 0}, input));  // another report
  CHECK_FALSE(protocol.decode(Bytes{3, 0, 1, 0, 1}, input));     // too short
  CHECK_FALSE(protocol.decode(Bytes{}, input));
  CHECK(input.position == last);
  CHECK(protocol.decode(Bytes{3, 0, 0x00, 0x80, 0, 0}, input));  // -32768: past the end
  CHECK(input.position[0] == -0.03);
  CHECK(protocol.info().low == Vec3{-0.03, -0.03, 0});
  CHECK(protocol.info().high == Vec3{0.03, 0.03, 0});
}

TEST_CASE("PID: a device that does not give a block") {
  PidProtocol protocol(kArduino.descriptor, {});
  const auto answer = [&](const Bytes& bytes) -> std::string {
    Channel channel;
    channel.answer = bytes;
    try {
      protocol.start(channel);
    } catch (const DeviceError& e) {
      return e.what();
    }
    return "";
  };
  CHECK(answer({6, 0, 2, 0, 0}) ==
        "Block Load: the device has no room for an effect: status 2, block 1");
  CHECK(answer({6, 0xff, 1, 0, 0}) ==
        "Block Load: the device has no room for an effect: status 1, block 0");
  CHECK(answer({6, 1}) == "Block Load: 2 bytes: too short");
  CHECK(answer({6}) == "Block Load: 1 bytes: too short");
  CHECK(protocol.stop() == std::vector<Bytes>{{0x0c, 3}});
}

TEST_CASE("PID: what a device lacks is named") {
  const auto pid_without = [](const Bytes& what, const Bytes& instead) {
    return refusal(without(kPidBits, sizeof kPidBits, what, instead));
  };
  const std::string no = "no PID device with two axes: it has no ";
  CHECK(refusal(Bytes(std::begin(kTeensyRawHid), std::end(kTeensyRawHid))) == no + "X axis");
  CHECK(refusal(Bytes(std::begin(kMouse), std::end(kMouse))) ==
        no + "Set Effect report for forces along X");
  // The usage of a report, or of a value in it, becomes another one.
  CHECK(pid_without({0x09, 0x73, 0xa1}, {0x09, 0xee}) ==
        no + "Set Constant Force report (block index)");
  CHECK(pid_without({0x09, 0x70, 0x16}, {0x09, 0xee}) ==
        no + "Set Constant Force report (magnitude)");
  CHECK(pid_without({0x09, 0x77, 0xa1}, {0x09, 0xee}) ==
        no + "Effect Operation report (block index)");
  CHECK(pid_without({0x09, 0x99}, {0x09, 0xee}) == no + "Device Control report (stop all effects)");
  CHECK(pid_without({0x09, 0x7d, 0xa1}, {0x09, 0xee}) == no + "Device Gain report");
  CHECK(pid_without({0x09, 0x90, 0xa1}, {0x09, 0xee}) == no + "Block Free report");
  CHECK(pid_without({0x09, 0xab, 0xa1}, {0x09, 0xee}) ==
        no + "Create New Effect report (constant force)");
  CHECK(pid_without({0x09, 0x89, 0xa1}, {0x09, 0xee}) == no + "Block Load report (block index)");
  CHECK(pid_without({0x09, 0x31, 0x16}, {0x09, 0x32}) == no + "Y axis");
  CHECK(pid_without({0x09, 0x31, 0x15}, {0x09, 0x32}) ==
        no + "Set Effect report for forces along Y");
  CHECK(pid_without({0x16, 0x01, 0x80, 0x26, 0xff, 0x7f, 0x36}, {0x16, 0x01, 0x00}) ==
        "no PID device with two axes: its magnitudes have one sign only");
  CHECK(pid_without({0x26, 0xff, 0x7f, 0x36, 0x01}, {0x26, 0x01, 0x80}) ==
        "no PID device with two axes: the range of its Set Constant Force report (magnitude) is "
        "empty");
  // 16 bits of a force in 8 bits would wrap around.
  CHECK(pid_without({0x75, 0x10, 0x95, 0x01, 0x91, 0x02, 0xc0, 0x09, 0x77}, {0x75, 0x08}) ==
        "no PID device with two axes: its magnitude goes to 32767 in 8 bits");
  // Another report begins between block index and magnitude.
  Bytes split(std::begin(kPidBits), std::end(kPidBits));
  const Bytes magnitude{0x09, 0x70, 0x16};
  const Bytes other_id{0x85, 0x20};
  split.insert(std::search(split.begin(), split.end(), magnitude.begin(), magnitude.end()),
               other_id.begin(), other_id.end());
  CHECK(
      refusal(split) ==
      "no PID device with two axes: its Set Constant Force report is spread over reports 5 and 32");
}

TEST_CASE("PID: parameters have ranges") {
  const auto make = [](const PidParameters& p) { PidProtocol(kArduino.descriptor, p); };
  CHECK_THROWS_WITH(make({.newtons = 0}), "PID: newtons 0: above 0");
  CHECK_THROWS_WITH(make({.half_range = -1}), "PID: half range -1: above 0");
  CHECK_THROWS_WITH(make({.half_range = std::nan("")}), "PID: half range nan: above 0");
  CHECK_THROWS_WITH(make({.signs = {1, 0.5}}), "PID: sign 0.5: 1 or -1");
}
