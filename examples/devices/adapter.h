/* What adapters in C have in common: the greeting, forces in, states out. README.md has the
 * protocol. */
#ifndef HAPGRID_EXAMPLES_DEVICES_ADAPTER_H
#define HAPGRID_EXAMPLES_DEVICES_ADAPTER_H

#include <errno.h>
#include <hapgrid/device.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

/* Says on standard error why the adapter ends. Returns its exit code. */
static inline int complain(const char* adapter, const char* what, const char* why) {
  fprintf(stderr, "%s: %s: %s\n", adapter, what, why);
  return 1;
}

/* The handle reaches from -reach to reach metres on three axes, around the device's middle. */
static inline hapgrid_device_greeting greeting(const char* name, double reach, double max_force,
                                               double rate) {
  hapgrid_device_greeting g = {.magic = HAPGRID_DEVICE_MAGIC,
                               .version = HAPGRID_DEVICE_VERSION,
                               .axes = 3,
                               .low = {-reach, -reach, -reach},
                               .high = {reach, reach, reach},
                               .max_force = max_force,
                               .rate = rate};
  strncpy(g.name, name, sizeof g.name - 1);
  return g;
}

/* To play; when that is gone, without a signal, so that the adapter can let go of its device. */
static inline int say(const void* message, size_t size) {
  return send(STDOUT_FILENO, message, size, MSG_NOSIGNAL) == (ssize_t)size;
}

/* Waits for the next force. When play is silent or gone, that is zero, with the number 0; and the
 * end, if play is gone. Returns whether it must be answered. */
static inline int next_force(hapgrid_device_force* force) {
  struct pollfd in = {.fd = STDIN_FILENO, .events = POLLIN};
  memset(force, 0, sizeof *force);
  if (poll(&in, 1, (int)(HAPGRID_DEVICE_SILENCE * 1000)) == 0) return 0;
  ssize_t got = read(STDIN_FILENO, force, sizeof *force);
  if (got == (ssize_t)sizeof *force) return 1;
  const int interrupted = got < 0 && errno == EINTR;
  memset(force, 0, sizeof *force);
  force->end = !interrupted;
  return 0;
}

/* Seconds on a clock that is never set. */
static inline double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
