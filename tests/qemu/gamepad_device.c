/* gamepad-device: an Xbox controller on Bluetooth, made by /dev/uhid; the kernel's hid-microsoft
 * drives it. While it is open X goes to its left end. It prints each output report, in hex, behind
 * the microseconds since the start, at once. */
#define _GNU_SOURCE
#include <poll.h>

#include "tests/hid/descriptors.h"
#include "tests/qemu/uhid.h"

int main(void) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  const int64_t began = now_ns();
  const int fd = uhid_create("Xbox Wireless Controller", BUS_BLUETOOTH, 0x045e, 0x02fd, kGamepad,
                             sizeof kGamepad);
  static struct uhid_event event;
  int64_t opened = 0;
  for (;;) {
    struct pollfd ready = {.fd = fd, .events = POLLIN};
    if (poll(&ready, 1, 8) > 0) {
      uhid_read(fd, &event);
      if (event.type == UHID_OPEN) opened = now_ns();
      if (event.type == UHID_CLOSE) opened = 0;
      if (event.type == UHID_OUTPUT) {
        printf("%lld", (long long)((now_ns() - began) / 1000));
        for (int i = 0; i < event.u.output.size; ++i) printf(" %02x", event.u.output.data[i]);
        puts("");
      }
    }
    if (!opened) continue;
    const unsigned char middle = now_ns() - opened < 100000000 ? 0x80 : 0;
    const unsigned char report[11] = {1, 0, middle, 0, 0x80, 0, 0x80, 0, 0x80, 0, 0};
    uhid_input(fd, report, sizeof report);
  }
}
