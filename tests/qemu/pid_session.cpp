// pid-session HIDRAW: what a play does with a joystick of the PID class, without a play: takes it
// into use, reads where the stick is, sends three forces, lets go. HIDRAW is its /dev/hidrawN. What
// the device saw is its own record (pid_device.c).
#include <linux/hidraw.h>
#include <poll.h>
#include <sys/ioctl.h>

#include <cstdio>
#include <iostream>

#include "libcore/base/error.hpp"
#include "libcore/device/pid.hpp"
#include "tests/qemu/uhid.h"

using namespace hapgrid;

namespace {

class Hidraw : public HidChannel {
 public:
  explicit Hidraw(const char* path) : fd_(open(path, O_RDWR | O_CLOEXEC)) {
    if (fd_ < 0) die(path);
  }
  ~Hidraw() override { close(fd_); }

  void write(std::span<const std::uint8_t> report) override {
    if (::write(fd_, report.data(), report.size()) != static_cast<ssize_t>(report.size())) {
      throw DeviceError("write");
    }
  }
  void set_feature(std::span<const std::uint8_t> report) override {
    HidReport copy(report.begin(), report.end());
    if (ioctl(fd_, HIDIOCSFEATURE(copy.size()), copy.data()) < 0) throw DeviceError("set feature");
  }
  HidReport get_feature(std::uint8_t id, std::size_t size) override {
    HidReport report(size);
    report[0] = id;
    const int got = ioctl(fd_, HIDIOCGFEATURE(report.size()), report.data());
    if (got < 0) throw DeviceError("get feature");
    report.resize(static_cast<std::size_t>(got));
    return report;
  }
  HidReport read() {
    struct pollfd waiting = {.fd = fd_, .events = POLLIN, .revents = 0};
    HidReport report(64);
    if (poll(&waiting, 1, 1000) != 1) throw DeviceError("no input report in a second");
    const ssize_t got = ::read(fd_, report.data(), report.size());
    if (got < 0) throw DeviceError("read");
    report.resize(static_cast<std::size_t>(got));
    return report;
  }
  HidDescriptor descriptor() {
    struct hidraw_report_descriptor d = {};
    int size = 0;
    if (ioctl(fd_, HIDIOCGRDESCSIZE, &size) < 0) throw DeviceError("descriptor's size");
    d.size = static_cast<std::uint32_t>(size);
    if (ioctl(fd_, HIDIOCGRDESC, &d) < 0) throw DeviceError("descriptor");
    return parse_hid_descriptor({d.value, d.size});
  }

 private:
  int fd_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    Hidraw hidraw(argv[1]);
    PidProtocol protocol(hidraw.descriptor(), {.half_range = 0.05, .newtons = 2, .signs = {1, 1}});
    protocol.start(hidraw);
    DeviceInput input;
    if (!protocol.decode(hidraw.read(), input)) throw DeviceError("the input report says nothing");
    std::printf("at %.6f %.6f\n", input.position[0], input.position[1]);
    std::vector<HidReport> reports;
    for (const Vec3& force : {Vec3{1, 1, 0}, Vec3{0.5, 2.5, 0}, Vec3{0, 0, 0}}) {
      protocol.encode(force, reports);
      for (const HidReport& report : reports) hidraw.write(report);
    }
    for (const HidReport& report : protocol.stop()) hidraw.write(report);
  } catch (const Error& e) {
    std::cerr << "pid-session: " << e.what() << "\n";
    return 1;
  }
  return 0;
}
