/* rawhid-device [--rate HZ] [--unplug-after N] POSITIONS
 *
 * A device for the hand with three axes and a force: 64-byte reports without an id in both
 * directions, "Teensy RawHID", vendor 16c0, product 0486, all numbers little-endian:
 *
 *   input   bytes 0-11   x, y, z: 3 x int32, micrometres
 *           bytes 12-15  uint32, number of the report, from 0
 *           byte  16     buttons, bit 0 is the first (always 0 here)
 *   output  bytes 0-5    force x, y, z: 3 x int16, millinewtons
 *           bytes 6-7    uint16, flags
 *
 * POSITIONS is a text file: three integers a line, micrometres; a line for each report, the last
 * one for ever. Reports begin when somebody opens the device, HZ (1000) times a second. After N
 * reports the device is unplugged.
 *
 * At the end, which SIGTERM or the unplugging is, the record goes to standard output, a line an
 * event, each with its time in microseconds after the first opening:
 *
 *   TIME open              somebody opened the device (the first of all)
 *   TIME close             nobody has it open any more
 *   TIME out X Y Z FLAGS   an output report: millinewtons
 *   TIME short SIZE        an output report of another size (with its id; 65 is right)
 *   TIME end REPORTS LATE BEGAN  how many input reports went out, the latest of them LATE
 *                          microseconds behind its time; CLOCK_MONOTONIC at the first opening
 *
 * Its priority is 60 of SCHED_FIFO: the device is no process of the machine it is plugged into, so
 * nothing there may hold it up. What an emulated HID device needs of Linux is in
 * Documentation/hid/uhid.rst. */
#define _GNU_SOURCE
#include <inttypes.h>
#include <linux/input.h>
#include <linux/uhid.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>

#include "tests/qemu/device.h"

/* Teensy RawHID: 64 bytes each way, no report id. */
static const unsigned char descriptor[] = {
    0x06, 0xab, 0xff, 0x0a, 0x00, 0x02, 0xa1, 0x01, 0x75, 0x08, 0x15, 0x00, 0x26, 0xff,
    0x00, 0x95, 0x40, 0x09, 0x01, 0x81, 0x02, 0x95, 0x40, 0x09, 0x02, 0x91, 0x02, 0xc0,
};

static void uhid_send(int fd, const struct uhid_event* event) {
  if (write(fd, event, sizeof *event) != (ssize_t)sizeof *event) die("write to /dev/uhid");
}

static int create(void) {
  const int fd = open("/dev/uhid", O_RDWR | O_CLOEXEC);
  if (fd < 0) die("/dev/uhid");
  static struct uhid_event event = {.type = UHID_CREATE2};
  struct uhid_create2_req* device = &event.u.create2;
  strcpy((char*)device->name, "Teensy RawHID");
  device->rd_size = sizeof descriptor;
  device->bus = BUS_USB;
  device->vendor = 0x16c0;
  device->product = 0x0486;
  memcpy(device->rd_data, descriptor, sizeof descriptor);
  uhid_send(fd, &event);
  return fd;
}

static void uhid_input(int fd, const void* report, size_t size) {
  static struct uhid_event event;
  event.type = UHID_INPUT2;
  event.u.input2.size = (uint16_t)size;
  memcpy(event.u.input2.data, report, size);
  uhid_send(fd, &event);
}

/* SIGTERM says that the record is wanted: it interrupts what waits in a ppoll() with `*waiting`. */
static volatile sig_atomic_t ended = 0;
static void on_term(int signal_number) {
  (void)signal_number;
  ended = 1;
}
static void catch_term(sigset_t* waiting) {
  const struct sigaction action = {.sa_handler = on_term};
  sigset_t blocked;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  sigaction(SIGTERM, &action, NULL);
  sigprocmask(SIG_BLOCK, &blocked, waiting);
  sigdelset(waiting, SIGTERM);
}

static FILE* record; /* in memory */
static int64_t first_open = -1;

/* Begins a line of the record. */
static FILE* say(void) {
  fprintf(record, "%.3f ", (double)(now_ns() - first_open) / 1e3);
  return record;
}

static void put32(unsigned char* at, uint32_t value) {
  for (int i = 0; i < 4; ++i) at[i] = (unsigned char)(value >> 8 * i);
}

static uint16_t get16(const unsigned char* at) { return (uint16_t)(at[0] | at[1] << 8); }

static void handle(const struct uhid_event* event, int* is_open) {
  if (event->type == UHID_OPEN) {
    if (first_open < 0) first_open = now_ns();
    fputs("open\n", say());
    *is_open = 1;
  } else if (event->type == UHID_CLOSE) {
    fputs("close\n", say());
    *is_open = 0;
  } else if (event->type == UHID_OUTPUT) {
    /* uhid passes on the 0 that stands for the id; on a USB cable there is none. */
    const unsigned char* data = event->u.output.data + 1;
    if (event->u.output.size != 65 || event->u.output.data[0] != 0)
      fprintf(say(), "short %u\n", event->u.output.size);
    else
      fprintf(say(), "out %d %d %d %u\n", (int16_t)get16(data), (int16_t)get16(data + 2),
              (int16_t)get16(data + 4), get16(data + 6));
  }
}

enum { kMostPositions = 1 << 14 };
static int32_t positions[kMostPositions][3];

static size_t read_positions(const char* name) {
  FILE* file = fopen(name, "r");
  if (!file) die(name);
  size_t count = 0;
  for (int32_t* p = positions[0]; count < kMostPositions; ++count, p += 3)
    if (fscanf(file, "%" SCNd32 " %" SCNd32 " %" SCNd32, p, p + 1, p + 2) != 3) break;
  if (!feof(file) || count == 0) die(name);
  fclose(file);
  return count;
}

int main(int argc, char** argv) {
  double rate = 1000;
  int64_t unplug_after = -1;
  const char* script = NULL;
  for (int i = 1; i < argc; ++i) {
    if (!strcmp(argv[i], "--rate") && i + 1 < argc) {
      rate = atof(argv[++i]);
    } else if (!strcmp(argv[i], "--unplug-after") && i + 1 < argc) {
      unplug_after = atoll(argv[++i]);
    } else {
      script = argv[i];
    }
  }
  if (!script || !(rate > 0)) {
    fputs("usage: rawhid-device [--rate HZ] [--unplug-after N] POSITIONS\n", stderr);
    return 2;
  }
  const size_t count = read_positions(script);
  const struct sched_param scheduling = {.sched_priority = 60};
  if (sched_setscheduler(0, SCHED_FIFO, &scheduling) != 0) die("SCHED_FIFO");
  /* To make room in between would take the machine's one processor too long. */
  static char text[1 << 22];
  record = fmemopen(text, sizeof text, "w");
  sigset_t waiting;
  catch_term(&waiting);

  const int fd = create();
  static struct uhid_event event;
  int is_open = 0;
  int64_t sent = 0;
  int64_t latest_ns = 0;
  while (!ended) {
    const int all_sent = unplug_after >= 0 && sent >= unplug_after;
    /* Between two reports it listens. A time that passed while nobody had it open is left out. */
    const int64_t due = first_open + (int64_t)((double)sent * 1e9 / rate);
    const int64_t left = due - now_ns();
    if (all_sent && left <= 0) break;
    if (is_open && left <= 0) {
      unsigned char report[64] = {0};
      const int32_t* p = positions[(size_t)sent < count ? (size_t)sent : count - 1];
      for (int i = 0; i < 3; ++i) put32(report + 4 * i, (uint32_t)p[i]);
      put32(report + 12, (uint32_t)sent);
      uhid_input(fd, report, sizeof report);
      if (-left > latest_ns) latest_ns = -left;
      ++sent;
      continue;
    }
    const struct timespec timeout = {left / 1000000000, left % 1000000000};
    struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
    if (ppoll(&poll_fd, 1, is_open ? &timeout : NULL, &waiting) > 0) {
      if (read(fd, &event, sizeof event) < 0) die("read from /dev/uhid");
      handle(&event, &is_open);
    }
  }
  if (unplug_after >= 0 && sent >= unplug_after)
    uhid_send(fd, &(struct uhid_event){.type = UHID_DESTROY});
  if (first_open < 0) first_open = now_ns();
  fprintf(say(), "end %" PRId64 " %.3f %.3f\n", sent, (double)latest_ns / 1e3,
          (double)first_open / 1e3);
  fclose(record);
  fputs(text, stdout);
  return 0;
}
