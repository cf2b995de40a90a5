// What a stick's events mean, and which effects a force becomes: numbers from the kernel's
// documentation (ff.rst, gamepad.rst, joystick-api.rst; linux/input.h), worked out by hand.

#include "tests/unit/catch.hpp"
#include "tests/unit/device/place.hpp"
#include "tests/unit/refusal.hpp"
#include "tests/unit/temporary_directory.hpp"
#include "tools/devices/effects.hpp"
#include "tools/devices/stick_list.hpp"

using namespace hapgrid;
using hapgrid::testing::place;

namespace {

input_event event(int type, int code, int value) {
  input_event e{};
  e.type = static_cast<std::uint16_t>(type);
  e.code = static_cast<std::uint16_t>(code);
  e.value = value;
  return e;
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

TEST_CASE("a gamepad steers, and has two buttons") {
  EvdevParameters parameters{.newtons = 4};
  EvdevLayout pad = usable_layout(gamepad(), parameters);
  pad.second_button = BTN_EAST;
  const hapgrid_device_greeting greeting = stick_greeting(pad, parameters, 1000);
  CHECK((greeting.flags & HAPGRID_DEVICE_STEERS) != 0);
  CHECK(greeting.max_force == 4);
  CHECK(greeting.low[0] == -1);
  CHECK(greeting.high[2] == 1);
  hapgrid_device_state state{};
  const auto take = [&](int type, int code, int value) {
    take_event(pad, parameters, event(type, code, value), state);
  };
  take(EV_ABS, ABS_X, 32767);
  take(EV_ABS, ABS_Y, -32768);  // forward
  take(EV_ABS, ABS_RY, 255);    // down
  CHECK(place(state) == Vec3{1, 1, -1});
  take(EV_ABS, ABS_Y, 0);
  CHECK_FALSE(std::signbit(state.position[1]));
  take(EV_KEY, BTN_SOUTH, 1);
  CHECK(state.flags == HAPGRID_DEVICE_RESET);
  take(EV_KEY, BTN_EAST, 1);
  CHECK(state.flags == (HAPGRID_DEVICE_RESET | HAPGRID_DEVICE_NEXT));
  take(EV_KEY, BTN_SOUTH, 0);
  CHECK(state.flags == HAPGRID_DEVICE_NEXT);
  take(EV_KEY, BTN_EAST, 0);
  CHECK(state.flags == 0);
  take(EV_ABS, ABS_Z, 9);
  take(EV_KEY, KEY_A, 1);
  CHECK(place(state) == Vec3{1, 0, -1});
  CHECK(state.flags == 0);

  EvdevLayout numb = gamepad();
  numb.rumble = false;
  CHECK(stick_greeting(numb, parameters, 1000).max_force == 0);
}

TEST_CASE("a stick with force is held") {
  EvdevParameters parameters{.half_range = 0.1, .newtons = 2};
  const EvdevLayout stick = usable_layout(joystick(), parameters);
  const hapgrid_device_greeting greeting = stick_greeting(stick, parameters, 1000);
  CHECK((greeting.flags & HAPGRID_DEVICE_STEERS) == 0);
  CHECK(greeting.low[1] == -0.1);
  CHECK(greeting.high[1] == 0.1);
  CHECK(greeting.high[2] == 0);
  CHECK(greeting.max_force == 2);
  hapgrid_device_state state{};
  const auto take = [&](int code, int value) {
    take_event(stick, parameters, event(EV_ABS, code, value), state);
  };
  take(ABS_X, 50);
  take(ABS_Y, 750);
  CHECK(state.position[0] == Approx(0.05));
  CHECK(state.position[1] == Approx(-0.05));
  take(ABS_RZ, 255);
  take(ABS_X, 1000);  // beyond its range
  CHECK(place(state) == Vec3{0.1, state.position[1], 0});

  EvdevParameters of_wheel{.half_range = 0.1, .signs = {1, 0}};
  const EvdevLayout wheel = usable_layout(joystick(), of_wheel);
  CHECK(stick_greeting(wheel, of_wheel, 1000).high[1] == 0);
}

TEST_CASE("parameters that cannot be are refused") {
  const auto why = [](EvdevParameters p) {
    return testing::refusal([&] { usable_layout(joystick(), p); });
  };
  CHECK(why({.half_range = 0}) == "evdev: half range 0: above 0");
  CHECK(why({.newtons = -1}) == "evdev: newtons -1: above 0");
  CHECK(why({.signs = {0, 1}}) == "evdev: sign 0 of x: 1 or -1");
  CHECK(why({.signs = {1, 0.5}}) == "evdev: sign 0.5 of y: 1, -1 or 0");
  EvdevParameters usual;
  CHECK(testing::refusal([&] { usable_layout({.name = "keyboard"}, usual); }) ==
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
  // An Xbox 360 pad as Linux 6.1 shows it: BTN_SOUTH is 0x130, FF_RUMBLE 0x50, FF_GAIN 0x60.
  add("event12", "X-Box\x01 360 pad", "3003f", "7cdb000000000000 0 0 0 0", "107030000 0", "0");
  // A stick with X, Y, BTN_TRIGGER and FF_CONSTANT (0x52).
  add("event3", "stick", "3", "1 0 0 0 0", "100040000 0", "0");
  // Its motion sensors; a touch screen; a keyboard.
  add("event4", "sensors", "3f", "0", "0", "40");
  add("event5", "screen", "3", "400 0 0 0 0 0", "0", "2");
  add("event6", "keyboard", "0", "fffffffffffffffe", "0", "0");
  const std::vector<EvdevInfo> all = list_evdev(sysfs.path().string());
  REQUIRE(all.size() == 2);
  CHECK((all[0].path == "/dev/input/event3" && all[0].constant && !all[0].rumble));
  CHECK((all[1].path == "/dev/input/event12" && !all[1].constant && all[1].rumble));
  CHECK(find_one_evdev(all, {}).product == "stick");
  CHECK(find_one_evdev(all, {.path = "/dev/input/event12"}).product == "X-Box  360 pad");
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
