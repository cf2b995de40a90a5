/* What an emulated HID device needs of Linux (Documentation/hid/uhid.rst). For programs that run in
 * the emulated machine alone: whatever goes wrong ends them with a line. */
#ifndef TESTS_QEMU_UHID_H
#define TESTS_QEMU_UHID_H

#include <errno.h>
#include <fcntl.h>
#include <linux/input.h>
#include <linux/uhid.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static inline void die(const char* what) {
  fprintf(stderr, "emulated device: %s: %s\n", what, strerror(errno));
  exit(1);
}

static inline int64_t now_ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static inline void uhid_send(int fd, const struct uhid_event* event) {
  if (write(fd, event, sizeof *event) != (ssize_t)sizeof *event) die("write to /dev/uhid");
}

/* A device on USB with this report descriptor. */
static inline int uhid_create(const char* name, uint32_t vendor, uint32_t product,
                              const unsigned char* descriptor, size_t size) {
  const int fd = open("/dev/uhid", O_RDWR | O_CLOEXEC);
  if (fd < 0) die("/dev/uhid");
  static struct uhid_event event;
  memset(&event, 0, sizeof event);
  event.type = UHID_CREATE2;
  snprintf((char*)event.u.create2.name, sizeof event.u.create2.name, "%s", name);
  event.u.create2.rd_size = (uint16_t)size;
  event.u.create2.bus = BUS_USB;
  event.u.create2.vendor = vendor;
  event.u.create2.product = product;
  memcpy(event.u.create2.rd_data, descriptor, size);
  uhid_send(fd, &event);
  return fd;
}

static inline void uhid_read(int fd, struct uhid_event* event) {
  if (read(fd, event, sizeof *event) < 0) die("read from /dev/uhid");
}

static inline void uhid_input(int fd, const void* report, size_t size) {
  static struct uhid_event event;
  event.type = UHID_INPUT2;
  event.u.input2.size = (uint16_t)size;
  memcpy(event.u.input2.data, report, size);
  uhid_send(fd, &event);
}

static inline void uhid_destroy(int fd) {
  static struct uhid_event event;
  event.type = UHID_DESTROY;
  uhid_send(fd, &event);
}

/* SIGTERM says that the record is wanted: it interrupts what waits in a ppoll() with `*waiting`. */
static volatile sig_atomic_t ended = 0;
static inline void on_term(int signal_number) {
  (void)signal_number;
  ended = 1;
}
static inline void catch_term(sigset_t* waiting) {
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_handler = on_term;
  sigaction(SIGTERM, &action, NULL);
  sigset_t blocked;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  sigprocmask(SIG_BLOCK, &blocked, waiting);
  sigdelset(waiting, SIGTERM);
}

#endif
