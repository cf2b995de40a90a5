#include "libcore/device/hid_bus.hpp"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "libcore/base/error.hpp"
#include "tests/unit/device/standin_device.hpp"
#include "tests/unit/refusal.hpp"
#include "tests/unit/temporary.hpp"

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

TEST_CASE("devices are listed in the order of their paths, with printable texts") {
  TemporaryDirectory directory;
  StandinDevice hardware(directory.file("socket"));
  CHECK(list_hid().empty());
  CHECK(list_text({}) == "no HID device\n");
  hardware.set_list(
      "/dev/hidraw10\t046d\tc626\t\t3Dconnexion\tSpaceNavigator\t0001\t0008\t-1\n"
      "/dev/hidraw9\t16c0\t0486\t1\x01"
      "2\tTeensyduino\tTeensy\xe9\tffab\t0200\t0\n"
      "/dev/hidraw9\t16c0\t0486\t1\x01"
      "2\tTeensyduino\tTeensy\xe9\tff31\t0074\t0\n");
  const std::vector<HidInfo> all = list_hid();
  REQUIRE(all.size() == 3);
  CHECK(list_text(all) ==
        "path\tvid:pid\tinterface\tusage\tserial\tname\n"
        "/dev/hidraw9\t16c0:0486\t0\tff31:0074\t1 2\tTeensyduino Teensyé\n"
        "/dev/hidraw9\t16c0:0486\t0\tffab:0200\t1 2\tTeensyduino Teensyé\n"
        "/dev/hidraw10\t046d:c626\t-\t0001:0008\t-\t3Dconnexion SpaceNavigator\n");
  CHECK(find_hid(all, {}).size() == 2);
  CHECK(find_one_hid(all, {.usage_page = 0xffab}, "").path == "/dev/hidraw9");
}

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

TEST_CASE("who may not open a device is told the rule that helps") {
  TemporaryDirectory directory;
  StandinDevice hardware(directory.file("socket"));
  // The path of a file that only its owner may open, looked at by somebody else.
  const std::string path = directory.file("hidraw0");
  std::ofstream(path) << "x";
  ::chmod(path.c_str(), 0600);
  ::chmod(directory.path().c_str(), 0755);
  ::chmod(directory.file("socket").c_str(), 0777);
  hardware.set_list(path + "\t16c0\t0486\t\t\tTeensy\tffab\t0200\t0\n");
  const std::string rule =
      "permission denied: put the line KERNEL==\"hidraw*\", ATTRS{idVendor}==\"16c0\", "
      "ATTRS{idProduct}==\"0486\", TAG+=\"uaccess\" into /etc/udev/rules.d/70-hapgrid.rules, then "
      "run 'udevadm control --reload && udevadm trigger' as root";
  CHECK(open_failure(path, "some reason") == path + ": cannot be opened: some reason");
  if (::getuid() != 0) {
    WARN("needs root to be somebody else");
    return;
  }
  const pid_t other = ::fork();
  if (other == 0) {
    const bool told = ::setuid(65534) == 0 &&
                      open_failure(path, "some reason") == path + ": " + rule &&
                      list_text(list_hid()).ends_with("\n" + path + ": " + rule + "\n");
    // At _exit() valgrind would take for lost what threads hold that are not in this process.
    if (told) ::kill(::getpid(), SIGKILL);
    ::_exit(1);
  }
  int status = -1;
  ::waitpid(other, &status, 0);
  CHECK((WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL));
}
