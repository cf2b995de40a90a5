// What a stick's events mean, and which effects a force becomes: numbers from the kernel's
// documentation (ff.rst, gamepad.rst, joystick-api.rst; linux/input.h), worked out by hand.
#include "libcore/device/evdev.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "libcore/base/error.hpp"
#include "libcore/device/evdev_bus.hpp"
#include "tests/unit/refusal.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;

namespace {

struct Channel : HidChannel {
  std::vector<HidReport> written;
  void write(std::span<const std::uint8_t> r) override { written.push_back({r.begin(), r.end()}); }
  void set_feature(std::span<const std::uint8_t>) override {}
};

ff_effect effect_of(const HidReport& report) {
  ff_effect effect{};
  REQUIRE(report.size() == 1 + sizeof effect);
  REQUIRE(report[0] == static_cast<std::uint8_t>(EvdevWord::kEffect));
  std::memcpy(&effect, &report[1], sizeof effect);
  return effect;
}

HidReport event(std::uint16_t type, std::uint16_t code, int value) {
  input_event e{};
  e.type = type;
  e.code = code;
  e.value = value;
  HidReport report(sizeof e);
  std::memcpy(report.data(), &e, sizeof e);
  return report;
}

EvdevLayout gamepad() {
  return {.name = "pad",
          .rumble = true,
          .axes = {EvdevAxis{ABS_X, -32768, 32767, 128}, EvdevAxis{ABS_Y, -32768, 32767, 128},
                   EvdevAxis{ABS_RY, 0, 255, 15}}};
}

EvdevLayout joystick() {
  return {.name = "stick",
          .constant = true,
          .gain = true,
          .autocenter = true,
          .axes = {EvdevAxis{ABS_X, -100, 100, 0}, EvdevAxis{ABS_Y, 0, 1000, 0},
                   EvdevAxis{ABS_RZ, 0, 255, 0}}};
}

}  // namespace

TEST_CASE("a constant force has a level and the direction in which it pulls") {
  const EvdevParameters of_2_newtons{.newtons = 2};
  const auto made = [&](double x, double y) { return constant_effect({x, y, 7}, of_2_newtons); };
  CHECK(made(0, 0).type == FF_CONSTANT);
  CHECK(made(0, 0).u.constant.level == 0);
  // linux/input.h: 0x0000 down, 0x4000 left, 0x8000 up, 0xC000 right; levels to 0x7fff.
  CHECK(made(0, -2).direction == 0x0000);
  CHECK(made(-2, 0).direction == 0x4000);
  CHECK(made(0, 2).direction == 0x8000);
  CHECK(made(2, 0).direction == 0xC000);
  CHECK(made(1, 1).direction == 0xA000);
  CHECK(made(2, 0).u.constant.level == 0x7fff);
  // Half is 16383.5; the diagonal of 1 N is 23169.7: towards zero. Never more than full.
  CHECK(made(1, 0).u.constant.level == 16383);
  CHECK(made(-1, 0).u.constant.level == 16383);
  CHECK(made(1, -1).u.constant.level == 23169);
  CHECK(made(30, -40).u.constant.level == 0x7fff);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    CHECK(made(bad, 1).u.constant.level == 0);
  // A wheel has no second motor, and a device may have its signs turned.
  const ff_effect wheel = constant_effect({1, 2, 0}, {.newtons = 2, .signs = {1, 0}});
  CHECK(wheel.u.constant.level == 16383);
  CHECK(wheel.direction == 0xC000);
  CHECK(constant_effect({1, 0, 0}, {.newtons = 2, .signs = {-1, 1}}).direction == 0x4000);
  CHECK(constant_effect({0, 1, 0}, {.newtons = 2, .signs = {1, -1}}).direction == 0x0000);
}

TEST_CASE("a rumble is as strong as the force, wherever that points") {
  const EvdevParameters of_4_newtons{.newtons = 4};
  const auto strong = [&](const Vec3& force) {
    return rumble_effect(force, of_4_newtons).u.rumble.strong_magnitude;
  };
  CHECK(rumble_effect({0, 0, 0}, of_4_newtons).type == FF_RUMBLE);
  CHECK(strong({0, 0, 0}) == 0);
  CHECK(strong({0, 0, -4}) == 0xffff);
  CHECK(strong({2, 0, 0}) == 0x7fff);  // 32767.5
  CHECK(strong({1, -2, 2}) == 49151);  // 3 / 4 of 65535 is 49151.25
  CHECK(strong({1e300, 0, 0}) == 0xffff);
  CHECK(strong({0, std::nan(""), 0}) == 0);
  CHECK(rumble_effect({4, 0, 0}, of_4_newtons).u.rumble.weak_magnitude == 0);
  CHECK(snap_effect().u.rumble.weak_magnitude == 0xffff);
  CHECK(snap_effect().u.rumble.strong_magnitude == 0);
}

TEST_CASE("no effect goes on for ever when nobody ends it") {
  for (const ff_effect& effect :
       {constant_effect({1, 0, 0}, {}), rumble_effect({1, 0, 0}, {}), snap_effect()}) {
    CHECK(effect.replay.length > 0);
    CHECK(effect.replay.length <= 250);
  }
  const EvdevProtocol stick(joystick(), {});
  CHECK(stick.timing().keep_alive < 0.25 / 2);
  CHECK(stick.keep_alive() == std::vector<HidReport>{{1, 0}});
}

TEST_CASE("a deflection as joydev has it") {
  // joydev: 0 up to `flat` around (low + high) / 2, then a line that is full `flat` before the end.
  constexpr int kLeast = std::numeric_limits<int>::min(), kMost = std::numeric_limits<int>::max();
  const struct {
    int low, high, flat, value;
    double rate;
  } rows[] = {{-32768, 32768, 128, 0, 0},
              {-32768, 32768, 128, 128, 0},
              {-32768, 32768, 128, -128, 0},
              {-32768, 32768, 128, 16384, 0.5},
              {-32768, 32768, 128, -16384, -0.5},
              {-32768, 32768, 128, 32768 - 128, 1},
              {-32768, 32768, 128, -32768, -1},
              // With the 15 that the kernel gives a gamepad: from 142.5 to 240.
              {0, 255, 15, 142, 0},
              {0, 255, 15, 143, 0.5 / 97.5},
              {0, 255, 15, 240, 1},
              {0, 255, 15, 15, -1},
              // No dead zone: a sixteenth of the range, 256.
              {0, 4096, 0, 2048 + 256, 0},
              {0, 4096, 0, 2048 + 1024, 0.5},
              // No flat is so large that nothing is left.
              {-1, 1, 1000, 1, 1},
              {-1, 1, 1000, 0, 0},
              {kLeast, kMost, 0, kMost, 1}};
  for (const auto& r : rows) {
    CAPTURE(r.high, r.value);
    CHECK(EvdevAxis{ABS_X, r.low, r.high, r.flat}.rate(r.value) == Approx(r.rate));
  }
  CHECK(EvdevAxis{ABS_X, kLeast, kMost, 0}.place(kLeast) == -1);
}

TEST_CASE("a gamepad steers, and its buttons reset") {
  EvdevProtocol pad(gamepad(), {.newtons = 4});
  CHECK(pad.info().unit == DeviceInfo::Unit::kRate);
  CHECK(pad.info().max_force == 4);
  DeviceInput input;
  CHECK(pad.decode(event(EV_ABS, ABS_X, 32767), input));
  CHECK(pad.decode(event(EV_ABS, ABS_Y, -32768), input));  // forward
  CHECK(pad.decode(event(EV_ABS, ABS_RY, 255), input));    // down
  CHECK(input.rate == Vec3{1, 1, -1});
  CHECK_FALSE(std::signbit((pad.decode(event(EV_ABS, ABS_Y, 0), input), input.rate[1])));
  CHECK(pad.decode(event(EV_KEY, BTN_SOUTH, 1), input));
  CHECK(input.reset);
  CHECK(pad.decode(event(EV_KEY, BTN_SOUTH, 0), input));
  CHECK_FALSE(input.reset);
  CHECK_FALSE(pad.decode(event(EV_ABS, ABS_Z, 9), input));
  CHECK_FALSE(pad.decode(event(EV_KEY, KEY_A, 1), input));
  CHECK_FALSE(pad.decode(HidReport{1, 2, 3}, input));
  CHECK(input.rate == Vec3{1, 0, -1});

  Channel channel;
  pad.start(channel);
  REQUIRE(channel.written.size() == 3);
  CHECK(effect_of(channel.written[0]).u.rumble.strong_magnitude == 0);
  CHECK(effect_of(channel.written[1]).id == kEvdevSnap);
  CHECK(channel.written[2] == HidReport{1, kEvdevForce});
  std::vector<HidReport> out;
  pad.encode({0, 4, 0}, out);
  REQUIRE(out.size() == 1);
  CHECK(effect_of(out[0]).u.rumble.strong_magnitude == 0xffff);
  CHECK(pad.snap() == std::vector<HidReport>{{1, kEvdevSnap}});
  CHECK(pad.stop() == std::vector<HidReport>{{3}});

  EvdevLayout numb = gamepad();
  numb.rumble = false;
  EvdevProtocol silent(numb, {});
  silent.encode({1, 0, 0}, out);
  CHECK(out.empty());
  CHECK(silent.stop().empty());
  CHECK(silent.snap().empty());
  CHECK(std::isinf(silent.info().max_force));
}

TEST_CASE("a stick with force is held") {
  EvdevProtocol stick(joystick(), {.half_range = 0.1, .newtons = 2});
  CHECK(stick.info().unit == DeviceInfo::Unit::kMetres);
  CHECK(stick.info().low == Vec3{-0.1, -0.1, 0});
  CHECK(stick.info().high == Vec3{0.1, 0.1, 0});
  CHECK(stick.info().max_force == 2);
  DeviceInput input;
  CHECK(stick.decode(event(EV_ABS, ABS_X, 50), input));
  CHECK(stick.decode(event(EV_ABS, ABS_Y, 750), input));
  CHECK(input.position[0] == Approx(0.05));
  CHECK(input.position[1] == Approx(-0.05));
  CHECK_FALSE(stick.decode(event(EV_ABS, ABS_RZ, 255), input));
  CHECK(stick.decode(event(EV_ABS, ABS_X, 1000), input));  // beyond its range
  CHECK(input.position == Vec3{0.1, input.position[1], 0});

  // The spring goes, the gain is full; then an effect without force plays.
  Channel channel;
  stick.start(channel);
  REQUIRE(channel.written.size() == 4);
  for (const auto& [at, code, value] : {std::tuple{0, FF_AUTOCENTER, 0}, {1, FF_GAIN, 0xffff}}) {
    HidReport wanted = event(EV_FF, static_cast<std::uint16_t>(code), value);
    wanted.insert(wanted.begin(), static_cast<std::uint8_t>(EvdevWord::kSet));
    CHECK(channel.written[static_cast<std::size_t>(at)] == wanted);
  }
  CHECK(effect_of(channel.written[2]).u.constant.level == 0);
  CHECK(channel.written[3] == HidReport{1, kEvdevForce});
  CHECK(stick.snap().empty());

  const EvdevProtocol wheel(joystick(), {.half_range = 0.1, .signs = {1, 0}});
  CHECK(wheel.info().high == Vec3{0.1, 0, 0});
}

TEST_CASE("parameters that cannot be are refused") {
  const auto why = [](const EvdevParameters& p) {
    return testing::refusal([&] { EvdevProtocol(joystick(), p); });
  };
  CHECK(why({.half_range = 0}) == "evdev: half range 0: above 0");
  CHECK(why({.newtons = -1}) == "evdev: newtons -1: above 0");
  CHECK(why({.signs = {0, 1}}) == "evdev: sign 0 of x: 1 or -1");
  CHECK(why({.signs = {1, 0.5}}) == "evdev: sign 0.5 of y: 1, -1 or 0");
  CHECK(testing::refusal([] { EvdevProtocol({.name = "keyboard"}, {}); }) ==
        "keyboard: has no stick");
}

TEST_CASE("sticks are found in sysfs, whoever may open them") {
  TemporaryDirectory sysfs;
  const auto add = [&](const std::string& event, const std::string& name, const std::string& abs,
                       const std::string& key, const std::string& ff, const std::string& prop) {
    const auto device = sysfs.path() / event / "device";
    std::filesystem::create_directories(device / "capabilities");
    std::filesystem::create_directories(device / "id");
    const char* const files[] = {"name",
                                 "uniq",
                                 "id/vendor",
                                 "id/product",
                                 "properties",
                                 "capabilities/abs",
                                 "capabilities/key",
                                 "capabilities/ff"};
    const std::string texts[] = {name, "", "045e", "028e", prop, abs, key, ff};
    for (int i = 0; i < 8; ++i) std::ofstream(device / files[i]) << texts[i] << "\n";
  };
  CHECK(list_evdev("/no/such").empty());
  CHECK(list_text(list_evdev(sysfs.path().string())).empty());
  // An Xbox 360 pad as Linux 6.1 shows it: BTN_SOUTH is 0x130, FF_RUMBLE 0x50, FF_GAIN 0x60.
  add("event12", "X-Box\x01 360 pad", "3003f", "7cdb000000000000 0 0 0 0", "107030000 0", "0");
  // A stick with X, Y, BTN_TRIGGER and FF_CONSTANT (0x52).
  add("event3", "stick", "3", "1 0 0 0 0", "100040000 0", "0");
  // Its motion sensors; a touch screen; a keyboard.
  add("event4", "sensors", "3f", "0", "0", "40");
  add("event5", "screen", "3", "400 0 0 0 0 0", "0", "2");
  add("event6", "keyboard", "0", "fffffffffffffffe", "0", "0");
  const std::vector<EvdevInfo> all = list_evdev(sysfs.path().string());
  CHECK(list_text(all) ==
        "path\tvid:pid\tfeels\tserial\tname\n"
        "/dev/input/event3\t045e:028e\tforce\t-\tstick\n"
        "/dev/input/event12\t045e:028e\trumble\t-\tX-Box  360 pad\n");
  CHECK(find_one_evdev(all, {}).name == "stick");
  CHECK(find_one_evdev(all, {.path = "/dev/input/event12"}).name == "X-Box  360 pad");
  CHECK(
      testing::refusal([&] { find_one_evdev(all, {.vid = 0x45e, .pid = 0x28e}); }) ==
      "2 gamepads or sticks are 045e:028e: stick (045e:028e) at /dev/input/event3, X-Box  360 pad "
      "(045e:028e) at /dev/input/event12: choose one by its path (--device evdev:WHICH)");
  CHECK(testing::refusal([&] { find_one_evdev(all, {.serial = "9"}); }) ==
        "no gamepad or stick is serial 9; there is stick (045e:028e) at /dev/input/event3, X-Box  "
        "360 pad (045e:028e) at /dev/input/event12 (play --list-devices shows all)");
  CHECK(testing::refusal([&] { find_one_evdev({}, {}); }) ==
        "there is no gamepad or stick (play --list-devices shows all)");
}
