// A program with a guarded device, for the tests to end in every way: it writes the guard's process
// id as a line, then sends forces until it is told how to end on its standard input.
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>

#include "libcore/device/hid_device.hpp"
#include "libcore/device/hid_guard.hpp"
#include "tests/unit/device/tiny_protocol.hpp"

int main() {
  hapgrid::HidGuard guard;
  hapgrid::HidDevice device("tiny", std::make_unique<TinyProtocol>(), &guard);
  std::printf("%d\n", static_cast<int>(guard.pid()));
  std::fflush(stdout);
  std::printf("never flushed twice");  // stays in the buffer, of which the guard has no copy
  std::atomic<char> how{0};
  std::thread listener([&how] {
    char c = 'x';
    (void)!::read(STDIN_FILENO, &c, 1);
    how = c;
  });
  while (how == 0) {
    if (device.send({7, 0, 0}) != hapgrid::DeviceStatus::kOk) {
      listener.detach();
      return 3;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  listener.join();
  if (how == 'a') std::abort();
  if (how == 's') ::raise(SIGSEGV);
  if (how == 'e') std::_Exit(0);
  return device.stop() == hapgrid::DeviceStatus::kOk ? 0 : 4;
}
