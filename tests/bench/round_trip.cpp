// How long a force takes to a device and a position back.
//
//   bench_round_trip RATE SECONDS path|COMMAND...
//
// At each tick of a paced loop under real time, a force is sent to a path device, or to the adapter
// that COMMAND starts. The round trip goes from there until the position that answers it can be
// read. A line for each bin: its lower edge in microseconds, and the part of all ticks; a last
// line, behind '#', has quantiles.
#include <poll.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/histogram.hpp"
#include "libcore/device/path.hpp"
#include "libcore/device/process_device.hpp"
#include "libcore/haptic/pacer.hpp"
#include "libcore/haptic/realtime.hpp"

namespace {

using namespace hapgrid;

int measure(double rate, double seconds, const std::vector<std::string>& command) {
  const auto ticks = static_cast<std::size_t>(rate * seconds);
  const bool is_path = command[0] == "path";
  ProcessGuard guard(command);
  std::unique_ptr<Device> device;
  if (is_path)
    device = std::make_unique<PathDevice>(std::vector<Vec3>(ticks + 1));
  else
    device = std::make_unique<ProcessDevice>(guard);
  Histogram times;
  {
    const Realtime realtime(RealtimeMode::kTry, device.get());
    std::fprintf(stderr, "%s: %s\n", device->info().name.c_str(), realtime.got().c_str());
    Pacer pacer(rate);
    const std::atomic<int> stop{0};
    DeviceInput input;
    if (device->read(input) != DeviceStatus::kOk) throw DeviceError(device->error());
    for (std::size_t i = 0; i < ticks; ++i) {
      pacer.wait(stop);
      const std::int64_t begin = monotonic_ns();
      bool good = device->send({0, 0, 0}) == DeviceStatus::kOk;
      pollfd answer{guard.wire(), POLLIN, 0};
      if (!is_path) good = ::poll(&answer, 1, 1000) == 1 && good;
      good = device->read(input) == DeviceStatus::kOk && good;
      if (!good) throw DeviceError(device->error());
      times.add(monotonic_ns() - begin);
    }
    device->stop();
  }
  for (const Histogram::Bin& bin : times.bins())
    std::printf("%.6g %.6g\n", 1e-3 * static_cast<double>(bin.from),
                static_cast<double>(bin.count) / static_cast<double>(ticks));
  std::printf("# p50 %.3g, p99 %.3g, p99.9 %.3g, max %.3g µs\n",
              1e-3 * static_cast<double>(times.quantile(0.5)),
              1e-3 * static_cast<double>(times.quantile(0.99)),
              1e-3 * static_cast<double>(times.quantile(0.999)),
              1e-3 * static_cast<double>(times.max()));
  return 0;
}

}  // namespace

int main(int count, char** words) {
  if (count < 4) {
    std::fputs("bench_round_trip RATE SECONDS path|COMMAND...\n", stderr);
    return 2;
  }
  try {
    return measure(std::atof(words[1]), std::atof(words[2]), {words + 3, words + count});
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_round_trip: %s\n", e.what());
    return 1;
  }
}
