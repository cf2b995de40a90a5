// A hidapi whose one device, a Teensy of the shipped profile, takes and gives reports at once. The
// time at which a report is written goes to the file HAPGRID_WRITTEN, as nanoseconds of
// CLOCK_MONOTONIC, which device.cpp maps.
#include <fcntl.h>
#include <hidapi/hidapi.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

static volatile int64_t* written;
static int device;

hid_device* hid_open_path(const char* path) {
  const int fd = open(getenv("HAPGRID_WRITTEN"), O_RDWR);
  written = mmap(NULL, sizeof *written, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  close(fd);
  return (hid_device*)&device;
}

void hid_close(hid_device* unused) {}

int hid_read_timeout(hid_device* unused, unsigned char* data, size_t length, int milliseconds) {
  // A report every two calls, so that who drains comes to an end.
  static __thread int calls;
  if (++calls % 2 == 0) {
    if (milliseconds > 0) usleep(500);
    return 0;
  }
  memset(data, 0, 64);
  data[0] = 0x48;
  return 64;
}

int hid_write(hid_device* unused, const unsigned char* data, size_t length) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  *written = (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
  return (int)length;
}

int hid_send_feature_report(hid_device* unused, const unsigned char* data, size_t length) {
  return (int)length;
}

const wchar_t* hid_error(hid_device* unused) { return L""; }

struct hid_device_info* hid_enumerate(unsigned short vendor, unsigned short product) {
  static wchar_t empty[1];
  static struct hid_device_info info;
  info = (struct hid_device_info){.path = (char*)"null",
                                  .vendor_id = 0x16c0,
                                  .product_id = 0x0486,
                                  .serial_number = empty,
                                  .manufacturer_string = empty,
                                  .product_string = empty,
                                  .usage_page = 0xffab,
                                  .usage = 0x0200,
                                  .interface_number = 0};
  return &info;
}

void hid_free_enumeration(struct hid_device_info* unused) {}
