/* What adapters in C have in common: the greeting, forces in, states out. README.md has the
 * protocol. */
#ifndef HAPGRID_EXAMPLES_DEVICES_ADAPTER_H
#define HAPGRID_EXAMPLES_DEVICES_ADAPTER_H

#include <errno.h>
#include <hapgrid/device.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

/* Tells play, or with --release the user, why the adapter ends. Returns its exit code. */
static inline int complain(const char* what, const char* why) {
  char text[256];
  const int size = snprintf(text, sizeof text, HAPGRID_DEVICE_ERROR "%s: %s", what, why);
  const size_t sent = size < (int)sizeof text ? (size_t)size : sizeof text - 1;
  if (send(STDOUT_FILENO, text, sent, MSG_NOSIGNAL) < 0) fprintf(stderr, "%s\n", text);
  return 1;
}

/* Whether the last word of the command line is --release, which is taken away. */
static inline int is_release(int* count, char** words) {
  if (*count < 2 || strcmp(words[*count - 1], "--release") != 0) return 0;
  --*count;
  return 1;
}

static volatile sig_atomic_t told_to_end;
static inline void on_term(int number) {
  (void)number;
  told_to_end = 1;
}

/* The handle reaches from -reach to reach metres on three axes, around the device's middle. From
 * now on SIGTERM only sets told_to_end, so that the adapter can let go of its device. */
static inline hapgrid_device_greeting greeting(const char* name, double reach, double max_force,
                                               double rate) {
  const struct sigaction action = {.sa_handler = on_term};
  sigaction(SIGTERM, &action, NULL);
  hapgrid_device_greeting g = {.magic = HAPGRID_DEVICE_MAGIC,
                               .version = HAPGRID_DEVICE_VERSION,
                               .flags = HAPGRID_DEVICE_RELEASES,
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

/* Waits for the next force. When play is silent or gone, or SIGTERM came, that is zero; and the
 * end, but for a silent play. Returns whether it must be answered. */
static inline int next_force(hapgrid_device_force* force) {
  struct pollfd in = {.fd = STDIN_FILENO, .events = POLLIN};
  memset(force, 0, sizeof *force);
  const int ready = poll(&in, 1, (int)(HAPGRID_DEVICE_SILENCE * 1000));
  if (ready == 0 && !told_to_end) return 0;
  if (!told_to_end && read(STDIN_FILENO, force, sizeof *force) == (ssize_t)sizeof *force)
    return force->number != 0;
  memset(force, 0, sizeof *force);
  force->flags = HAPGRID_DEVICE_END;
  return 0;
}

/* Flags of a state, from a mask of pressed buttons: the first is the clutch, the second takes the
 * next level. */
static inline uint32_t flags_of(unsigned long buttons) {
  return (buttons & 1 ? HAPGRID_DEVICE_CLUTCH : 0) | (buttons & 2 ? HAPGRID_DEVICE_NEXT : 0);
}

/* Seconds on a clock that is never set. */
static inline double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
