// How long a force takes from the loop to a device, and its answer back:
//
//     bench_device RATE COMMAND...
//     bench_device RATE             a bare socket to a process that only answers
//
// COMMAND is an adapter; for that of HID devices, LD_LIBRARY_PATH names the folder of
// null_hidapi.c. The second line is what the machine needs for any adapter.
#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "libcore/device/process_device.hpp"
#include "libcore/loop/pacer.hpp"
#include "libcore/loop/realtime.hpp"

using namespace hapgrid;

namespace {

/// Two seconds of round trips, and the times at which each force reached the device.
template <typename Exchange>
void measure(double rate, const char* got, const volatile std::int64_t* written,
             const Exchange& exchange) {
  const std::atomic<int> stop{0};
  Clock clock;
  Pacer pacer(clock, rate);
  Histogram out, trip;
  for (int i = 0; i < 2 * rate; ++i) {
    pacer.wait(stop);
    const std::int64_t began = monotonic_ns();
    if (!exchange(0.001 * (i % 1000))) break;
    trip.add(monotonic_ns() - began);
    if (*written > began) out.add(*written - began);
  }
  std::printf("%g Hz, %s: round trip p50 %.1f, p99 %.1f us; to the device p50 %.1f us\n", rate, got,
              1e-3 * static_cast<double>(trip.quantile(0.5)),
              1e-3 * static_cast<double>(trip.quantile(0.99)),
              1e-3 * static_cast<double>(out.quantile(0.5)));
}

/// The other end of a bare socket.
[[noreturn]] void answer(int socket, volatile std::int64_t* written) {
  const sched_param priority{.sched_priority = kDevicePriority};
  ::sched_setscheduler(0, SCHED_FIFO, &priority);
  hapgrid_device_state state{};
  for (hapgrid_device_force force; ::read(socket, &force, sizeof force) == sizeof force;) {
    *written = monotonic_ns();
    if (::write(socket, &state, sizeof state) < 0) break;
  }
  ::_exit(0);
}

void measure_bare(double rate, volatile std::int64_t* written) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends) != 0) return;
  if (::fork() == 0) {
    ::close(ends[0]);
    answer(ends[1], written);
  }
  ::close(ends[1]);
  const Realtime realtime(RealtimeMode::kTry);
  measure(rate, realtime.got().c_str(), written, [&](double) {
    const hapgrid_device_force force{};
    hapgrid_device_state state;
    return ::write(ends[0], &force, sizeof force) == sizeof force &&
           ::read(ends[0], &state, sizeof state) == sizeof state;
  });
  ::close(ends[0]);
  ::wait(nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const double rate = std::atof(argv[1]);
  char file[] = "/tmp/written.XXXXXX";
  const int fd = ::mkstemp(file);
  if (::ftruncate(fd, 8) != 0) return 1;
  auto* written = static_cast<volatile std::int64_t*>(
      ::mmap(nullptr, 8, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0));
  ::setenv("HAPGRID_WRITTEN", file, 1);
  bool good = true;
  if (argc == 2) {
    measure_bare(rate, written);
  } else {
    const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    ProcessDevice device({.command = {argv + 2, argv + argc},
                          .name = "adapter",
                          .guard = folder.parent_path() / "bin/hapgrid-guard"});
    const Realtime realtime(RealtimeMode::kTry, &device);
    DeviceInput input;
    measure(rate, realtime.got().c_str(), written, [&](double force) {
      return device.send({force, 0, 0}) == DeviceStatus::kOk &&
             device.read(input) == DeviceStatus::kOk;
    });
    good = device.stop() == DeviceStatus::kOk;
  }
  ::unlink(file);
  return good ? 0 : 1;
}
