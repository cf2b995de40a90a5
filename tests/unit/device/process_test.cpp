// Devices that are processes; tests/cli/play/process.sh has adapters that misbehave.
#include <sys/wait.h>
#include <unistd.h>

#include "libcore/device/process_device.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"
#include "tests/unit/refusal.hpp"
#include "tests/unit/temporary_directory.hpp"

using namespace hapgrid;

namespace {

AdapterProgram program(const std::vector<std::string>& command) {
  return {.command = command, .name = "adapter", .guard = HAPGRID_BUILD_DIR "/bin/hapgrid-guard"};
}

AdapterProgram adapter(const std::string& record, const std::string& mode) {
  return program(
      {"/usr/bin/python3", HAPGRID_SOURCE_DIR "/tests/cli/play/adapter.py", record, mode});
}

bool exists(pid_t pid) { return std::filesystem::exists("/proc/" + std::to_string(pid)); }

}  // namespace

TEST_CASE("reading and sending take no memory") {
  TemporaryDirectory directory;
  pid_t pid = -1;
  {
    ProcessDevice device(adapter(directory.file("record"), "good"));
    pid = device.adapter();
    CHECK(exists(pid));
    const DeviceInfo info = device.info();
    CHECK(info.name == "puppet");
    CHECK(info.unit == DeviceInfo::Unit::kMetres);
    CHECK(info.low == Vec3{-0.08, -0.08, -0.08});
    CHECK(info.high == Vec3{0.08, 0.08, 0.08});
    CHECK(info.max_force == 3);
    CHECK(device.rate_hz() == 1000);
    DeviceInput input;
    CHECK(testing::ticks_without_allocating(device, 100) == 100);
    REQUIRE(device.read(input) == DeviceStatus::kOk);
    CHECK(input.position == Vec3{-0.04, 0, 0});
    CHECK_FALSE(input.clutch);
    CHECK(device.stop() == DeviceStatus::kOk);
    CHECK(device.stop() == DeviceStatus::kOk);
    CHECK(device.read(input) == DeviceStatus::kFailed);
  }
  CHECK_FALSE(exists(pid));
}

TEST_CASE("an adapter that cannot be started leaves nothing to end") {
  const auto begin = std::chrono::steady_clock::now();
  const auto why = [](const AdapterProgram& none) {
    return testing::refusal([&] { ProcessGuard guard(none); });
  };
  CHECK(why(program({"/no/such/program"})) ==
        "adapter: cannot be started: No such file or directory");
  CHECK(why({.command = {"true"}, .name = "adapter", .guard = "/no/such/guard"}) ==
        "the guard process /no/such/guard cannot be started: No such file or directory");
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(2));
}

TEST_CASE("adapter and guard have their sockets, and no other file of the program's") {
  TemporaryDirectory directory;
  int pipe[2];
  REQUIRE(::pipe(pipe) == 0);  // without O_CLOEXEC
  ProcessDevice device(adapter(directory.file("record"), "good"));
  int of_guard = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator("/proc/" + std::to_string(device.guard()) + "/fd/")) {
    const std::string to = std::filesystem::read_symlink(entry.path()).string();
    CAPTURE(entry.path(), to);
    CHECK((to.starts_with("socket:") || entry.path().filename() == "2"));
    ++of_guard;
  }
  CHECK(of_guard == 3);
  const std::string files = "/proc/" + std::to_string(device.adapter()) + "/fd/";
  for (const auto& entry : std::filesystem::directory_iterator(files)) {
    const std::string name = entry.path().filename().string();
    const std::string to = std::filesystem::read_symlink(entry.path()).string();
    CAPTURE(name, to);
    if (name == "0" || name == "1")
      CHECK(to.starts_with("socket:"));
    else
      CHECK((name == "2" || to == directory.file("record")));
  }
  ::close(pipe[0]);
  ::close(pipe[1]);
}

TEST_CASE("states are checked to the last bit of their ranges") {
  hapgrid_device_greeting greeting{.magic = HAPGRID_DEVICE_MAGIC,
                                   .version = HAPGRID_DEVICE_VERSION,
                                   .flags = 0,
                                   .low = {-0.1, 0, 0},
                                   .high = {0.1, 0.1, 0},
                                   .max_force = 1,
                                   .rate = 20,
                                   .name = "two axes"};
  REQUIRE(greeting_flaw(greeting, sizeof greeting).empty());
  const auto flaw = [&](double x, double time, std::uint32_t number, std::size_t size) {
    hapgrid_device_state state{};
    state.time = time;
    state.position[0] = x;
    state.number = number;
    return state_flaw(greeting, state, size, 7, 1);
  };
  CHECK(flaw(0.2, 1, 7, 40) == AdapterFault::kNone);  // the longest side is 0.2: half of it beyond
  CHECK(flaw(std::nextafter(0.2, 1), 1, 7, 40) == AdapterFault::kOutside);
  CHECK(flaw(-0.21, 1, 7, 40) == AdapterFault::kOutside);
  CHECK(flaw(0, std::nextafter(1, 0), 7, 40) == AdapterFault::kBackwards);
  CHECK(flaw(0, std::nan(""), 7, 40) == AdapterFault::kNotFinite);
  CHECK(flaw(0, 1, 6, 40) == AdapterFault::kNumber);
  CHECK(flaw(0, 1, 7, 39) == AdapterFault::kSize);
  CHECK(flaw(0, 1, 7, 41) == AdapterFault::kSize);

  // A name may fill its field.
  std::fill(std::begin(greeting.name), std::end(greeting.name), 'n');
  CHECK(device_info(greeting, "").name == std::string(48, 'n'));
  greeting.name[0] = '\0';
  CHECK(device_info(greeting, "process 'x'").name == "process 'x'");
  CHECK_FALSE(greeting_flaw(greeting, 127).empty());
  greeting.high[0] = greeting.low[0] + 1e-6;
  CHECK(greeting_flaw(greeting, 128) == "says that its x goes from -0.1 to -0.099999 m");
}
