#include "tools/devices/hid_bus.hpp"

#include "tests/unit/catch.hpp"
#include "tests/unit/refusal.hpp"
#include "tests/unit/temporary_directory.hpp"

using namespace hapgrid;

namespace {

const HidInfo kTeensy{.path = "/dev/hidraw0",
                      .vid = 0x16c0,
                      .pid = 0x0486,
                      .serial = "1234",
                      .manufacturer = "Teensyduino",
                      .product = "Teensy RawHID",
                      .usage_page = 0xffab,
                      .usage = 0x0200,
                      .interface = 0};

}  // namespace

TEST_CASE("WHICH is a path, the numbers, or a serial") {
  CHECK(parse_hid_match("16c0:0486").fits(kTeensy));
  CHECK(parse_hid_match("16C0:0486:1234").fits(kTeensy));
  CHECK_FALSE(parse_hid_match("16c0:0486:123").fits(kTeensy));
  CHECK_FALSE(parse_hid_match("16c0:0487").fits(kTeensy));
  CHECK(parse_hid_match("1234").fits(kTeensy));
  CHECK(parse_hid_match("").fits(kTeensy));
  CHECK(parse_hid_match("16c0:048").serial == "16c0:048");
  CHECK(parse_hid_match("16c0:048x").serial == "16c0:048x");
  CHECK(parse_hid_match("/no/such").path == "/no/such");
  TemporaryDirectory directory;
  std::ofstream(directory.file("device")) << "x";
  std::filesystem::create_symlink(directory.file("device"), directory.file("link"));
  CHECK(parse_hid_match(directory.file("link")).path ==
        std::filesystem::canonical(directory.file("device")).string());
  CHECK(testing::refusal([] { parse_hid_match("/dev/"); }) == "/dev: is a directory, not a device");
}

TEST_CASE("what was not found, or found twice, is a message that helps") {
  HidInfo second = kTeensy;
  second.path = "/dev/hidraw1";
  second.serial = "5678";
  const HidMatch match{.vid = 0x16c0, .pid = 0x0486, .usage_page = 0xffab, .usage = 0x0200};
  CHECK(testing::refusal([&] {
          find_one_hid({kTeensy, second}, match, "--device spacemouse:WHICH");
        }) ==
        "2 devices are 16c0:0486, usage ffab:0200: Teensy RawHID (16c0:0486) at /dev/hidraw0 with "
        "serial 1234, Teensy RawHID (16c0:0486) at /dev/hidraw1 with serial 5678: choose one by "
        "its path or serial (--device spacemouse:WHICH)");
  CHECK(testing::refusal([&] { find_one_hid({kTeensy}, {.serial = "9"}, ""); }) ==
        "no device is serial 9; there is Teensy RawHID (16c0:0486) at /dev/hidraw0 with serial "
        "1234 (play --list-devices shows all)");
  CHECK(testing::refusal([&] { find_one_hid({}, match, ""); }) ==
        "no device is 16c0:0486, usage ffab:0200; there is no HID device at all (play "
        "--list-devices shows all)");
  CHECK(find_one_hid({kTeensy, second}, {.serial = "5678"}, "").path == "/dev/hidraw1");
}
