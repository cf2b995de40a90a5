#include "libcore/device/hid_descriptor.hpp"

#include <catch2/catch.hpp>
#include <random>

#include "libcore/base/error.hpp"
#include "libcore/device/hid_describe.hpp"
#include "libcore/device/hid_report.hpp"
#include "tests/hid/descriptors.h"

using namespace hapgrid;
using Bytes = std::vector<std::uint8_t>;

namespace {

std::string refusal(const Bytes& bytes) {
  try {
    parse_hid_descriptor(bytes);
  } catch (const DeviceError& e) {
    return e.what();
  }
  return "";
}

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

// Decoded by hand with the tables of HID 1.11, Sect. 6.2.2. tests/qemu asks Linux for all of them.

TEST_CASE("Teensy RawHID: 64 bytes each way, without an id") {
  const HidDescriptor d = parse_hid_descriptor(kTeensyRawHid);
  REQUIRE(d.fields.size() == 2);
  CHECK(d.application(d.fields[0]) == HidUsage{0xffab, 0x0200});
  CHECK(d.fields[0].kind == HidReportKind::kInput);
  CHECK(d.fields[1].kind == HidReportKind::kOutput);
  for (const HidField& field : d.fields) {
    CHECK(field.report_id == 0);
    CHECK(field.bit_offset == 0);
    CHECK(field.bit_size == 8);
    CHECK(field.count == 64);
    CHECK(field.variable);
    CHECK(field.logical_max == 255);
  }
  CHECK(d.report_bytes(HidReportKind::kInput, 0) == 65);
  CHECK(d.report_bytes(HidReportKind::kInput, 1) == 0);
  CHECK(d.report_bytes(HidReportKind::kFeature, 0) == 0);
}

TEST_CASE("SpaceMouse: axes, and globals that hold until they are set anew") {
  const HidDescriptor d = parse_hid_descriptor(kSpaceMouse);
  CHECK(d.application(d.fields[0]) == HidUsage{1, 8});
  CHECK(d.report_bytes(HidReportKind::kInput, 1) == 13);
  const auto rz = d.find(HidReportKind::kInput, {1, 0x35});
  REQUIRE(rz);
  CHECK(rz->bit_offset == 80);
  CHECK(rz->logical_min == -350);
  CHECK(rz->logical_max == 350);
  const HidField& axes = d.fields[0];
  CHECK(axes.physical_min == -1400);
  CHECK(axes.physical_max == 1400);
  CHECK(axes.unit == 0x11);
  CHECK(axes.unit_exponent == -4);
  CHECK_FALSE(axes.relative);
  // A list of six keys of 256: an array, whose values choose.
  const HidField& keys = d.fields[3];
  CHECK_FALSE(keys.variable);
  CHECK(keys.report_id == 0x1c);
  CHECK(keys.usage_count() == 256);
  CHECK(keys.usage(255) == HidUsage{9, 255});
  CHECK(keys.usage(256) == std::nullopt);
  CHECK(read_element(Bytes{1, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 0xa2, 0xfe}, *rz) == -350);
  CHECK(read_element(Bytes{2, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 0xa2, 0xfe}, *rz) == std::nullopt);
  CHECK(read_element(Bytes{1, 1, 0, 2, 0, 3, 0}, *rz) == std::nullopt);
}

TEST_CASE("mouse: relative, padding, signed bytes") {
  const HidDescriptor d = parse_hid_descriptor(kMouse);
  REQUIRE(d.fields.size() == 3);
  CHECK(d.fields[1].constant);
  CHECK(d.fields[1].usages.empty());
  CHECK(d.fields[2].relative);
  CHECK(d.fields[2].bit_offset == 8);
  CHECK(read_element(Bytes{0, 0, 5, 0x81}, *d.find(HidReportKind::kInput, {1, 0x31})) == -127);
  CHECK(read_element(Bytes{0, 4, 5, 0x81}, *d.find(HidReportKind::kInput, {9, 3})) == 1);
  CHECK(read_element(Bytes{0, 3, 5, 0x81}, *d.find(HidReportKind::kInput, {9, 3})) == 0);
  CHECK_FALSE(d.find(HidReportKind::kInput, {9, 4}));
  CHECK_FALSE(d.find(HidReportKind::kOutput, {9, 3}));
}

TEST_CASE("gamepad: unsigned bytes, a nibble, push and pop") {
  const HidDescriptor d = parse_hid_descriptor(kGamepad);
  REQUIRE(d.fields.size() == 5);
  CHECK(d.fields[0].logical_max == 255);
  CHECK(d.fields[1].bit_offset == 32);
  CHECK(d.fields[1].bit_size == 4);
  CHECK(d.fields[1].physical_max == 315);
  CHECK(d.fields[1].unit == 0x14);
  CHECK(d.fields[2].bit_offset == 36);
  CHECK(d.fields[2].count == 12);
  // Behind the pop: 4 x 8 bits, 0 to 255 again.
  CHECK(d.fields[3].bit_offset == 48);
  CHECK(d.fields[3].count == 4);
  CHECK(d.fields[3].logical_max == 255);
  CHECK(d.fields[3].usage(0) == HidUsage{0xff00, 0});
  CHECK(d.fields[4].kind == HidReportKind::kOutput);
  CHECK(d.fields[4].count == 7);
  const auto hat = d.find(HidReportKind::kInput, {1, 0x39});
  const auto button12 = d.find(HidReportKind::kInput, {9, 12});
  REQUIRE(hat);
  REQUIRE(button12);
  const Bytes report{0, 0xff, 0x80, 0x80, 0x80, 0x17, 0x80, 1, 2, 3, 4};
  CHECK(read_element(report, *d.find(HidReportKind::kInput, {1, 0x30})) == 255);
  CHECK(read_element(report, *hat) == 7);
  CHECK(read_element(report, *button12) == 1);
}

TEST_CASE("values are written where they belong, and nothing else changes") {
  const HidDescriptor d = parse_hid_descriptor(kGamepad);
  const auto hat = d.find(HidReportKind::kInput, {1, 0x39});
  REQUIRE(hat);
  Bytes report(11, 0xff);
  report[0] = 0;
  CHECK(write_element(report, *hat, 2));
  CHECK(report == Bytes{0, 0xff, 0xff, 0xff, 0xff, 0xf2, 0xff, 0xff, 0xff, 0xff, 0xff});
  CHECK(write_element(report, *hat, -1));
  CHECK(report[5] == 0xff);
  Bytes small(5);
  CHECK_FALSE(write_element(small, *hat, 2));
  CHECK(small == Bytes(5));

  // 13 bits from bit 5 on, signed: -2 is 1 1111 1111 1110.
  const HidElement element{.bit_offset = 5, .bit_size = 13, .logical_min = -4096};
  Bytes odd(4);
  CHECK(write_element(odd, element, -2));
  CHECK(odd == Bytes{0, 0xc0, 0xff, 0x03});
  CHECK(read_element(odd, element) == -2);
  const HidElement word{.bit_offset = 0, .bit_size = 32, .logical_min = -1};
  Bytes five(5);
  CHECK(write_element(five, word, -2147483648LL));
  CHECK(five == Bytes{0, 0, 0, 0, 0x80});
  CHECK(read_element(five, word) == -2147483648LL);
  CHECK(read_element(five, {.bit_size = 32}) == 2147483648LL);
  CHECK_FALSE(read_element(Bytes(9), {.bit_size = 33}));
}

TEST_CASE("PID reports are told apart by their collections") {
  const HidDescriptor d = parse_hid_descriptor(kPidArray);
  const HidUsage index{0x0f, 0x22};
  CHECK(d.find(HidReportKind::kOutput, index, HidUsage{0x0f, 0x21})->report_id == 1);
  CHECK(d.find(HidReportKind::kOutput, index, HidUsage{0x0f, 0x73})->report_id == 5);
  CHECK(d.find(HidReportKind::kFeature, index, HidUsage{0x0f, 0x89})->report_id == 6);
  CHECK_FALSE(d.find(HidReportKind::kOutput, index, HidUsage{0x0f, 0x5a}));
  // The same id, 5, is an output of 4 bytes and a feature of 4; 1 is an output of 16.
  CHECK(d.report_bytes(HidReportKind::kOutput, 5) == 4);
  CHECK(d.report_bytes(HidReportKind::kFeature, 5) == 4);
  CHECK(d.report_bytes(HidReportKind::kOutput, 1) == 16);
  CHECK(parse_hid_descriptor(kPidBits).report_bytes(HidReportKind::kOutput, 1) == 18);
  // Device reset is number 4 of a list from 1, or a bit.
  CHECK(d.find(HidReportKind::kOutput, {0x0f, 0x9a})->choice == 4);
  const auto bit = parse_hid_descriptor(kPidBits).find(HidReportKind::kOutput, {0x0f, 0x9a});
  REQUIRE(bit);
  CHECK(bit->choice == 1);
  CHECK(bit->bit_offset == 3);
  CHECK(bit->bit_size == 1);
}

TEST_CASE("pages, ranges, delimiters, long items") {
  const Bytes field{0x75, 8, 0x95, 1, 0x81, 2};
  // A usage's page is the one at the main item, unless each usage was followed by its own, or it
  // carries one.
  const HidDescriptor late = parse_hid_descriptor(Bytes{5, 1, 9, 0x30, 5, 9} + field);
  CHECK(late.fields[0].usage(0) == HidUsage{9, 0x30});
  const HidDescriptor mixed =
      parse_hid_descriptor(Bytes{5, 1, 9, 0x30, 5, 9, 9, 2, 0xb, 3, 0, 0xf, 0} + field);
  CHECK(mixed.fields[0].usage(0) == HidUsage{1, 0x30});
  CHECK(mixed.fields[0].usage(1) == HidUsage{9, 2});
  CHECK(mixed.fields[0].usage(2) == HidUsage{0xf, 3});
  // The largest ranges there are, backwards ones, and half of one.
  const HidDescriptor wide = parse_hid_descriptor(
      Bytes{5, 1, 0x19, 0, 0x2a, 0xff, 0xff, 0x19, 0, 0x2a, 0xff, 0xff, 0x19, 9, 0x29, 8, 0x29, 5} +
      field);
  CHECK(wide.fields[0].usages.size() == 2);
  CHECK(wide.fields[0].usage_count() == 131072);
  // Of alternatives for one usage the first counts.
  const HidDescriptor either =
      parse_hid_descriptor(Bytes{5, 1, 0xa9, 1, 9, 0x30, 9, 0x31, 0xa9, 0, 9, 0x32} + field);
  CHECK(either.fields[0].usage_count() == 2);
  CHECK(either.fields[0].usage(1) == HidUsage{1, 0x32});
  const HidDescriptor skipped =
      parse_hid_descriptor(Bytes{0xfe, 3, 0xf0, 0xff, 0xff, 0xff} + field);
  CHECK(skipped.fields.size() == 1);
  // A maximum is signed when its minimum is, in either order.
  const HidDescriptor backwards = parse_hid_descriptor(Bytes{0x25, 0xff, 0x15, 0x80} + field);
  CHECK(backwards.fields[0].logical_max == -1);
}

TEST_CASE("a bad descriptor gets one line") {
  CHECK(refusal({}) == "report descriptor: it is empty");
  CHECK(refusal(Bytes(4097)) == "report descriptor: 4097 bytes: at most 4096");
  CHECK(refusal({5, 1, 0x26, 0}) ==
        "report descriptor: byte 2: the descriptor ends inside this item");
  CHECK(refusal({0xfe, 200, 0}) ==
        "report descriptor: byte 0: the descriptor ends inside this item");
  CHECK(refusal({0xa1, 1}) == "report descriptor: byte 0: a collection is not closed");
  CHECK(refusal({0xa1, 1, 0xc0, 0xc0}) ==
        "report descriptor: byte 3: closes a collection that is not open");
  CHECK(refusal({0xb4}) == "report descriptor: byte 0: pops what was not pushed");
  CHECK(refusal({0x85, 0}) == "report descriptor: byte 0: report id 0: 1 to 255 are there");
  CHECK(refusal({0x86, 0, 1}) == "report descriptor: byte 0: report id 256: 1 to 255 are there");
  // 2^32 - 1 values of 2^32 - 1 bits; one bit more than fits; as much as fits.
  CHECK(refusal({0x77, 255, 255, 255, 255, 0x97, 255, 255, 255, 255, 0x81, 2}) ==
        "report descriptor: byte 10: report 0 gets longer than 16384 bytes");
  CHECK(refusal({0x75, 1, 0x97, 0xf9, 0xff, 1, 0, 0x81, 2}) ==
        "report descriptor: byte 7: report 0 gets longer than 16384 bytes");
  CHECK(refusal({0x75, 1, 0x97, 0xf8, 0xff, 1, 0, 0x81, 2}).empty());
}

TEST_CASE("whatever the bytes, it is parsed or refused, and found and told in bounds") {
  std::mt19937 random(7);
  const auto byte = [&] { return static_cast<std::uint8_t>(random()); };
  std::size_t parsed = 0;
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes;
    if (round % 2 == 0) {  // real ones with some bytes changed
      const auto& real =
          kDescriptors[static_cast<std::size_t>(round) / 2 % std::size(kDescriptors)];
      bytes.assign(real.bytes, real.bytes + real.size);
      for (int i = 0; i < 3; ++i) bytes[random() % bytes.size()] = byte();
    } else {
      bytes.resize(1 + random() % 64);
      for (std::uint8_t& b : bytes) b = byte();
    }
    try {
      const HidDescriptor d = parse_hid_descriptor(bytes);
      ++parsed;
      for (const HidField& field : d.fields) {
        // In its report; and its first usage is found in a report, or hidden by none before it.
        REQUIRE(field.bit_offset + std::uint64_t{field.bit_size} * field.count <=
                8 * (d.report_bytes(field.kind, field.report_id) - 1));
        if (const auto usage = field.usage(0)) REQUIRE(d.find(field.kind, *usage));
      }
      describe(d);
    } catch (const DeviceError&) {
    }
  }
  CHECK(parsed > 1000);
}

TEST_CASE("the largest descriptors are told in few words") {
  // As many collections as fit, each in the last one, then fields; usages without end.
  Bytes deep;
  for (int i = 0; i < 600; ++i) deep = deep + Bytes{9, 1, 0xa1, 2};
  deep = deep + Bytes{0x75, 1, 0x95, 1};
  for (int i = 0; i < 400; ++i) deep = deep + Bytes{0x81, 2};
  deep = deep + Bytes(600, 0xc0);
  const std::string told = describe(parse_hid_descriptor(deep));
  CHECK(told.size() < 200000);
}

TEST_CASE("a descriptor is told a line a field") {
  CHECK(describe(parse_hid_descriptor(kMouse)) ==
        "Mouse\n"
        "  input 0: byte 1 bit 0: 3 x 1 bit: Button 1 to Button 3: logical 0..1\n"
        "  input 0: byte 1 bit 3: 5 bits: padding\n"
        "  input 0: byte 2 bit 0: 2 x 8 bits: X, Y: logical -127..127, relative\n");
  const std::string pid = describe(parse_hid_descriptor(kPidHighIds));
  CHECK(pid.find("  output 105: byte 2 bit 0: 16 bits: Magnitude (in Set Constant Force Report): "
                 "logical -4096..4096, physical -4096..4096\n") != std::string::npos);
  CHECK(describe(parse_hid_descriptor(kTeensyRawHid)) ==
        "ffab:0200\n"
        "  input 0: byte 1 bit 0: 64 x 8 bits: ffab:0001: logical 0..255\n"
        "  output 0: byte 1 bit 0: 64 x 8 bits: ffab:0002: logical 0..255\n");
}
