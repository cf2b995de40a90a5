// What happens to a device, with the stand-in library in the place of hidapi (LD_LIBRARY_PATH).
#include "libcore/device/hid_device.hpp"

#include <dlfcn.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <cstring>
#include <thread>

#include "libcore/base/error.hpp"
#include "tests/unit/device/standin_device.hpp"
#include "tests/unit/device/tiny_protocol.hpp"
#include "tests/unit/haptic/count_allocations.hpp"
#include "tests/unit/refusal.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;
using namespace std::chrono_literals;
using Bytes = StandinDevice::Bytes;
using Clock = std::chrono::steady_clock;

namespace {

// No watchdog, and no stall that a slow machine would see: a test asks for them.
constexpr HidTiming kPatient{.stall = 1000, .watchdog = 0, .keep_alive = 0};

struct Rig {
  TemporaryDirectory directory;
  StandinDevice hardware{directory.file("socket")};

  Rig() {
    // Linked against the library that is installed, run with the stand-in.
    const auto version =
        reinterpret_cast<const char* (*)()>(::dlsym(RTLD_DEFAULT, "hid_version_str"));
    REQUIRE((version && std::strcmp(version(), "stand-in") == 0));
  }
  std::unique_ptr<HidDevice> open(HidTiming timing = kPatient,
                                  const std::vector<HidReport>& alive = {}) {
    hardware.input({0xA5, 20}, true);
    return std::make_unique<HidDevice>("tiny", std::make_unique<TinyProtocol>(timing, alive));
  }
  std::string refusal(HidTiming timing = kPatient) {
    return testing::refusal(
        [&] { HidDevice device("tiny", std::make_unique<TinyProtocol>(timing)); });
  }
  /// Reads until the condition holds for what was read.
  template <class Condition>
  bool read_until(HidDevice& device, Condition&& condition) {
    return hardware.wait([&] {
      DeviceInput input;
      const DeviceStatus status = device.read(input);
      return condition(status, input);
    });
  }
  /// The last reports that were written, oldest first.
  std::vector<Bytes> last(std::size_t count) const {
    std::vector<Bytes> all = hardware.written();
    if (all.size() > count) all.erase(all.begin(), all.end() - static_cast<std::ptrdiff_t>(count));
    return all;
  }
};

const std::vector<Bytes> kStopped{TinyProtocol::force(0), TinyProtocol::stopped()};

}  // namespace

TEST_CASE("a device is opened twice, started, and has a position at once") {
  Rig rig;
  const auto device = rig.open();
  DeviceInput input;
  REQUIRE(device->read(input) == DeviceStatus::kOk);
  CHECK(input.position == Vec3{0.020, 0, 0});
  CHECK_FALSE(input.stalled);
  CHECK(device->info().name == "tiny");
  CHECK(rig.hardware.opened() == 2);
  CHECK(rig.hardware.written() == std::vector<Bytes>{TinyProtocol::started()});
  rig.hardware.input({0xA5, 33});
  CHECK(rig.read_until(
      *device, [](DeviceStatus, const DeviceInput& in) { return in.position[0] == 0.033; }));
  REQUIRE(device->send({5, 0, 0}) == DeviceStatus::kOk);
  CHECK(rig.hardware.wait_for_writes(2));
  CHECK(rig.last(1).front() == TinyProtocol::force(5));
  CHECK_FALSE(rig.hardware.written_by_two());
}

TEST_CASE("the newest of several reports and the newest of several forces count") {
  Rig rig;
  const auto device = rig.open();
  rig.hardware.hold_writes();
  REQUIRE(device->send({1, 0, 0}) == DeviceStatus::kOk);
  REQUIRE(rig.hardware.wait([&] { return rig.hardware.held() == 1; }));
  for (int i = 2; i <= 50; ++i) REQUIRE(device->send({double(i), 0, 0}) == DeviceStatus::kOk);
  rig.hardware.release_writes();
  CHECK(rig.hardware.wait_for_writes(3));
  CHECK(device->stop() == DeviceStatus::kOk);
  CHECK(rig.hardware.written() ==
        std::vector<Bytes>{TinyProtocol::started(), TinyProtocol::force(1), TinyProtocol::force(50),
                           TinyProtocol::force(0), TinyProtocol::stopped()});
}

TEST_CASE("stop(), or else the destructor, has zero force and the stop reports written last") {
  Rig rig;
  auto device = rig.open();
  REQUIRE(device->send({9, 0, 0}) == DeviceStatus::kOk);
  const bool stops = GENERATE(true, false);
  if (stops) CHECK(device->stop() == DeviceStatus::kOk);
  if (!stops) device.reset();
  CHECK(rig.last(2) == kStopped);
  if (!stops) return;
  const std::size_t count = rig.hardware.written().size();
  CHECK(device->stop() == DeviceStatus::kOk);
  CHECK(device->send({9, 0, 0}) == DeviceStatus::kOk);
  device.reset();
  CHECK(rig.hardware.wait([&] { return rig.hardware.open() == 0; }));
  CHECK(rig.hardware.written().size() == count);
}

TEST_CASE("without send() the force is zero, once, until it comes again") {
  Rig rig;
  const auto device = rig.open({.stall = 1000, .watchdog = 0.1, .keep_alive = 0});
  for (std::uint64_t round = 1; round <= 2; ++round) {
    REQUIRE(device->send({8, 0, 0}) == DeviceStatus::kOk);
    REQUIRE(rig.hardware.wait([&] { return device->counts().watchdog_zeros == round; }));
    const std::size_t count = rig.hardware.written().size();
    std::this_thread::sleep_for(300ms);  // nothing comes: no condition to wait for
    CHECK(rig.last(1).front() == TinyProtocol::force(0));
    CHECK(rig.hardware.written().size() <= count + 1);
    CHECK(device->counts().watchdog_zeros == round);
  }
  CHECK(device->stop() == DeviceStatus::kOk);
}

TEST_CASE("a force that waited behind a write that hung is too old") {
  Rig rig;
  const auto device = rig.open({.stall = 1000, .watchdog = 0.1, .keep_alive = 0});
  rig.hardware.hold_writes();
  REQUIRE(device->send({1, 0, 0}) == DeviceStatus::kOk);
  REQUIRE(rig.hardware.wait([&] { return rig.hardware.held() == 1; }));
  REQUIRE(device->send({2, 0, 0}) == DeviceStatus::kOk);
  std::this_thread::sleep_for(200ms);  // more than the watchdog, less than a write may take
  rig.hardware.release_writes();
  CHECK(rig.hardware.wait([&] { return device->counts().watchdog_zeros == 1; }));
  CHECK(device->stop() == DeviceStatus::kOk);
  for (const Bytes& report : rig.hardware.written()) CHECK(report != TinyProtocol::force(2));
}

TEST_CASE("keep-alive repeats the force, or writes its own reports") {
  Rig rig;
  const Bytes alive{0, 0x77};
  const bool own = GENERATE(false, true);
  const auto device = rig.open({.stall = 1000, .watchdog = 0, .keep_alive = 0.01},
                               own ? std::vector<HidReport>{alive} : std::vector<HidReport>{});
  REQUIRE(device->send({4, 0, 0}) == DeviceStatus::kOk);
  const Bytes expected = own ? alive : TinyProtocol::force(4);
  CHECK(
      rig.hardware.wait([&] { return std::ranges::count(rig.hardware.written(), expected) >= 5; }));
  if (own) CHECK(std::ranges::count(rig.hardware.written(), TinyProtocol::force(4)) == 1);
  CHECK(device->stop() == DeviceStatus::kOk);
  CHECK(rig.last(2) == kStopped);
}

TEST_CASE("a snap is told once, before the force of its branch") {
  Rig rig;
  const auto device = rig.open();
  for (const int newtons : {1, 2, 3}) {
    if (newtons == 2) device->snap();
    REQUIRE(device->send({static_cast<double>(newtons), 0, 0}) == DeviceStatus::kOk);
    REQUIRE(rig.hardware.wait([&] { return rig.last(1).front() == TinyProtocol::force(newtons); }));
  }
  CHECK(rig.last(4) == std::vector<Bytes>{TinyProtocol::force(1), TinyProtocol::snapped(),
                                          TinyProtocol::force(2), TinyProtocol::force(3)});
  CHECK(device->stop() == DeviceStatus::kOk);
}

TEST_CASE("where nobody else keeps it from it, the writer rests after each force") {
  Rig rig;
  const auto device = rig.open({.stall = 1000, .watchdog = 0, .rest = 0.03});
  const std::uint64_t before = device->counts().forces;
  const auto began = Clock::now();
  for (int i = 1; i <= 60; ++i) {
    REQUIRE(device->send({static_cast<double>(i), 0, 0}) == DeviceStatus::kOk);
    std::this_thread::sleep_for(2ms);
  }
  const auto forces = static_cast<double>(device->counts().forces - before);
  CHECK(forces <= 1 + std::chrono::duration<double>(Clock::now() - began).count() / 0.03);
  CHECK(rig.hardware.wait([&] { return rig.last(1).front() == TinyProtocol::force(60); }));
  CHECK(device->stop() == DeviceStatus::kOk);
}

TEST_CASE("silence is a stall; a cut report is no sign of life, the next whole one ends it") {
  Rig rig;
  const auto device = rig.open({.stall = 0.05, .watchdog = 0, .keep_alive = 0});
  CHECK(rig.read_until(*device, [](DeviceStatus status, const DeviceInput& in) {
    return status == DeviceStatus::kOk && in.stalled && in.position[0] == 0.020;
  }));
  CHECK(rig.read_until(*device, [&](DeviceStatus, const DeviceInput& in) {
    rig.hardware.input({0xA5});
    return in.stalled && device->counts().rejected > 3;
  }));
  CHECK(device->counts().inputs == 1);
  CHECK(rig.read_until(*device, [&](DeviceStatus, const DeviceInput& in) {
    rig.hardware.input({0xA5, 44});
    return !in.stalled && in.position[0] == 0.044;
  }));
}

TEST_CASE("no position is made up") {
  Rig rig;
  CHECK(rig.refusal() == "tiny: no input within 2 s: the device sent no report");
  CHECK(rig.last(2) == kStopped);
  rig.hardware.input({0xA5, 1, 2, 3}, true);
  CHECK(rig.refusal() ==
        "tiny: no input within 2 s: 1 reports that are not its input, the first one was report 0 "
        "of 4 bytes");
  CHECK(rig.hardware.wait([&] { return rig.hardware.open() == 0; }));

  // A device that is silent at rest is at rest.
  HidDevice device("tiny", std::make_unique<TinyProtocol>(HidTiming{.stall = 0}));
  DeviceInput input;
  REQUIRE(device.read(input) == DeviceStatus::kOk);
  CHECK(input.position == Vec3{0, 0, 0});
  CHECK_FALSE(input.stalled);
}

TEST_CASE("what came while the device was started is too old") {
  Rig rig;
  rig.hardware.input({0xA5, 20}, true);
  auto protocol = std::make_unique<TinyProtocol>(kPatient);
  protocol->while_starting = [&rig] {
    for (int i = 0; i < 10; ++i) rig.hardware.input({0xA5, 77});
  };
  HidDevice device("tiny", std::move(protocol));
  DeviceInput input;
  REQUIRE(device.read(input) == DeviceStatus::kOk);
  CHECK(input.position == Vec3{0.020, 0, 0});
  CHECK(device.counts().inputs == 1);
}

TEST_CASE("a device that cannot be opened or started says why") {
  Rig rig;
  rig.hardware.set_refusal("out of order");
  CHECK(rig.refusal() == "tiny: cannot be opened: out of order");
  rig.hardware.set_refusal("");
  rig.hardware.answer_writes(1, -1, "broken pipe");
  CHECK(rig.refusal() == "tiny: output report 0: broken pipe");
  CHECK(rig.last(2) == kStopped);
}

TEST_CASE("a device that cannot be started nor stopped does not hold up its constructor") {
  Rig rig;
  auto protocol = std::make_unique<TinyProtocol>(kPatient);
  protocol->while_starting = [&rig] {
    rig.hardware.hold_writes();
    throw DeviceError("no effect could be made");
  };
  const auto start = Clock::now();
  CHECK_THROWS_WITH(HidDevice("tiny", std::move(protocol)), "no effect could be made");
  CHECK(Clock::now() - start < 5s);
  rig.hardware.release_writes();
  CHECK(rig.hardware.wait([&] { return rig.hardware.written() == kStopped; }));
  CHECK(rig.hardware.wait([&] { return rig.hardware.open() == 0; }));
}

TEST_CASE("a failed write, a short one and a failed read are the end, and the device is let go") {
  Rig rig;
  const auto device = rig.open();
  const std::string what = GENERATE(as<std::string>{}, "write: took only 2 bytes of it",
                                    "write: broken pipe", "read: poll error");
  DeviceInput input;
  if (what.starts_with("read")) {
    rig.hardware.read_error("poll error");
    CHECK(rig.hardware.wait([&] { return device->read(input) == DeviceStatus::kFailed; }));
  } else {
    const bool is_short = what.ends_with("it");
    rig.hardware.answer_writes(1, is_short ? 2 : -1, is_short ? "" : "broken pipe");
    CHECK(rig.hardware.wait([&] { return device->send({6, 0, 0}) == DeviceStatus::kFailed; }));
    CHECK(device->read(input) == DeviceStatus::kFailed);
  }
  CHECK(rig.hardware.wait([&] { return rig.last(2) == kStopped; }));
  CHECK(device->error() == "tiny: " + what);
  CHECK(device->stop() == DeviceStatus::kOk);  // it did take the zero force
}

TEST_CASE("letting go is tried again when the device is said to be stopped") {
  Rig rig;
  const auto device = rig.open();
  rig.hardware.answer_writes(3, -1, "busy");  // the force, and both of letting go
  REQUIRE(device->send({6, 0, 0}) == DeviceStatus::kOk);
  REQUIRE(rig.hardware.wait_for_writes(4));
  CHECK(device->stop() == DeviceStatus::kOk);
  CHECK(rig.hardware.written().size() == 6);
  CHECK(rig.last(2) == kStopped);
}

TEST_CASE("an unplugged device fails, and could not be stopped") {
  Rig rig;
  const auto device = rig.open();
  rig.hardware.vanish();
  CHECK(rig.hardware.wait([&] { return device->send({1, 0, 0}) == DeviceStatus::kFailed; }));
  CHECK(device->error().find("device disconnected") != std::string::npos);
  CHECK(device->stop() == DeviceStatus::kFailed);
}

TEST_CASE("a write that hangs fails, and stop() waits for it a second") {
  Rig rig;
  auto device = rig.open();
  rig.hardware.hold_writes();
  REQUIRE(device->send({3, 0, 0}) == DeviceStatus::kOk);
  SECTION("the loop goes on") {
    CHECK(rig.hardware.wait([&] { return device->send({3, 0, 0}) == DeviceStatus::kFailed; }));
    CHECK(device->error() == "tiny: write: the device did not take a report within 500 ms");
  }
  SECTION("the loop stops") {
    REQUIRE(rig.hardware.wait([&] { return rig.hardware.held() == 1; }));
    const auto start = Clock::now();
    CHECK(device->stop() == DeviceStatus::kFailed);
    CHECK(Clock::now() - start < 5s);
    CHECK(device->error() == "tiny: stop: the device did not take the zero force within 1 s");
  }
  device.reset();
  CHECK(rig.hardware.written().size() == 2);
  // Whenever the kernel lets the thread go, the zero force goes out.
  rig.hardware.release_writes();
  CHECK(rig.hardware.wait([&] { return rig.last(2) == kStopped; }));
  CHECK(rig.hardware.wait([&] { return rig.hardware.open() == 0; }));
}

TEST_CASE("a read that hangs does not keep stop() from letting go") {
  Rig rig;
  auto device = rig.open();
  rig.hardware.read_sleep(1500);
  std::this_thread::sleep_for(100ms);  // the reader has taken it
  CHECK(device->stop() == DeviceStatus::kOk);
  CHECK(rig.last(2) == kStopped);
  device.reset();
  CHECK(rig.hardware.wait([&] { return rig.hardware.open() == 0; }));
}

TEST_CASE("a device that sends without pause starves nobody") {
  Rig rig;
  const auto device = rig.open();
  rig.hardware.flood({0xA5, 99});
  CHECK(rig.read_until(*device, [&](DeviceStatus status, const DeviceInput& in) {
    return status == DeviceStatus::kOk && in.position[0] == 0.099 && device->counts().floods > 2;
  }));
  REQUIRE(device->send({2, 0, 0}) == DeviceStatus::kOk);
  CHECK(rig.hardware.wait_for_writes(2));
  CHECK(device->stop() == DeviceStatus::kOk);
  rig.hardware.stop_flood();
  CHECK(rig.last(2) == kStopped);
}

TEST_CASE("read() and send() do not allocate") {
  Rig rig;
  const auto device = rig.open();
  CHECK(testing::ticks_without_allocating(*device, 1000) == 1000);
}
