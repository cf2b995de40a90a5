// How long a force takes from the loop to a device, and its answer back:
//
//     bench_device RATE COMMAND...
//
// COMMAND is an adapter; for that of HID devices, LD_LIBRARY_PATH names the folder of
// null_hidapi.c.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>

#include "libcore/base/file.hpp"
#include "libcore/device/process_device.hpp"
#include "libcore/loop/pacer.hpp"
#include "libcore/loop/realtime.hpp"

using namespace hapgrid;

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const double rate = std::atof(argv[1]);
  char file[] = "/tmp/written.XXXXXX";
  const int fd = ::mkstemp(file);
  if (::ftruncate(fd, 8) != 0) return 1;
  auto* written = static_cast<volatile std::int64_t*>(
      ::mmap(nullptr, 8, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0));
  ::setenv("HAPGRID_WRITTEN", file, 1);
  ProcessDevice device({.command = {argv + 2, argv + argc},
                        .name = "adapter",
                        .guard = own_folder().parent_path() / "bin/hapgrid-guard"});
  const Realtime realtime(RealtimeMode::kTry, &device);
  DeviceInput input;
  const std::atomic<int> stop{0};
  Clock clock;
  Pacer pacer(clock, rate);
  Histogram out, trip;
  for (int i = 0; i < 2 * rate; ++i) {  // two seconds of round trips
    pacer.wait(stop);
    const std::int64_t began = monotonic_ns();
    if (device.send({0.001 * (i % 1000), 0, 0}) != DeviceStatus::kOk ||
        device.read(input) != DeviceStatus::kOk)
      break;
    trip.add(monotonic_ns() - began);
    if (*written > began) out.add(*written - began);
  }
  std::printf("%g Hz, %s: round trip p50 %.1f, p99 %.1f us; to the device p50 %.1f us\n", rate,
              realtime.got().c_str(), 1e-3 * static_cast<double>(trip.quantile(0.5)),
              1e-3 * static_cast<double>(trip.quantile(0.99)),
              1e-3 * static_cast<double>(out.quantile(0.5)));
  ::unlink(file);
  return device.stop() == DeviceStatus::kOk ? 0 : 1;
}
