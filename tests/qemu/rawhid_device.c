/* rawhid-device [--rate HZ] [--unplug-after N [--silent MS]] [--priority P] POSITIONS
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
 * reports the device is unplugged; with --silent it first sends nothing for MS milliseconds, as one
 * whose cable breaks on the way in.
 *
 * At the end, which SIGTERM or the unplugging is, the record goes to standard output, a line an
 * event, each with its time in microseconds after the first opening:
 *
 *   TIME open              somebody opened the device (the first of all)
 *   TIME close             nobody has it open any more
 *   TIME out X Y Z FLAGS   an output report: millinewtons
 *   TIME short SIZE        an output report of another size (with its id; 65 is right)
 *   TIME end REPORTS LATE  how many input reports went out, the latest of them LATE microseconds
 *                          behind its time
 *
 * P is a priority of SCHED_FIFO (default 60): the device is no process of the machine it is plugged
 * into, so nothing there may hold it up. */
#define _GNU_SOURCE
#include <inttypes.h>
#include <poll.h>
#include <sched.h>

#include "tests/qemu/uhid.h"

/* Teensy RawHID: 64 bytes each way, no report id. */
static const unsigned char descriptor[] = {
    0x06, 0xab, 0xff, 0x0a, 0x00, 0x02, 0xa1, 0x01, 0x75, 0x08, 0x15, 0x00, 0x26, 0xff,
    0x00, 0x95, 0x40, 0x09, 0x01, 0x81, 0x02, 0x95, 0x40, 0x09, 0x02, 0x91, 0x02, 0xc0,
};

struct record {
  int64_t time_ns;
  char what; /* o open, c close, f force, s short */
  int16_t force[3];
  uint16_t flags;
};

static struct record* records;
static size_t record_count, record_room;
static int64_t first_open = -1;

static struct record* add(char what) {
  if (record_count == record_room) {
    record_room = record_room ? 2 * record_room : 65536;
    records = realloc(records, record_room * sizeof *records);
    if (!records) die("memory");
  }
  struct record* r = &records[record_count++];
  memset(r, 0, sizeof *r);
  r->time_ns = now_ns();
  r->what = what;
  return r;
}

static void put32(unsigned char* at, uint32_t value) {
  for (int i = 0; i < 4; ++i) at[i] = (unsigned char)(value >> 8 * i);
}

static uint16_t get16(const unsigned char* at) { return (uint16_t)(at[0] | at[1] << 8); }

static void handle(const struct uhid_event* event, int* is_open) {
  if (event->type == UHID_OPEN) {
    const struct record* r = add('o');
    if (first_open < 0) first_open = r->time_ns;
    *is_open = 1;
  } else if (event->type == UHID_CLOSE) {
    add('c');
    *is_open = 0;
  } else if (event->type == UHID_OUTPUT) {
    /* uhid passes on the 0 that stands for the id; on a USB cable there is none. */
    const unsigned char* data = event->u.output.data + 1;
    if (event->u.output.size != 65 || event->u.output.data[0] != 0) {
      add('s')->flags = event->u.output.size;
      return;
    }
    struct record* r = add('f');
    for (int i = 0; i < 3; ++i) r->force[i] = (int16_t)get16(data + 2 * i);
    r->flags = get16(data + 6);
  }
}

static int32_t (*read_positions(const char* name, size_t* count))[3] {
  FILE* file = fopen(name, "r");
  if (!file) die(name);
  int32_t(*positions)[3] = NULL;
  size_t room = 0;
  int32_t p[3];
  *count = 0;
  while (fscanf(file, "%" SCNd32 " %" SCNd32 " %" SCNd32, &p[0], &p[1], &p[2]) == 3) {
    if (*count == room) {
      room = room ? 2 * room : 4096;
      positions = realloc(positions, room * sizeof *positions);
      if (!positions) die("memory");
    }
    memcpy(positions[(*count)++], p, sizeof p);
  }
  if (!feof(file) || *count == 0) {
    errno = EINVAL;
    die(name);
  }
  fclose(file);
  return positions;
}

static void print_record(int64_t sent, int64_t latest_ns) {
  for (size_t i = 0; i < record_count; ++i) {
    const struct record* r = &records[i];
    printf("%.3f ", (double)(r->time_ns - first_open) / 1e3);
    if (r->what == 'o') puts("open");
    if (r->what == 'c') puts("close");
    if (r->what == 's') printf("short %u\n", r->flags);
    if (r->what == 'f') {
      printf("out %d %d %d %u\n", r->force[0], r->force[1], r->force[2], r->flags);
    }
  }
  const int64_t end = first_open < 0 ? 0 : now_ns() - first_open;
  printf("%.3f end %" PRId64 " %.3f\n", (double)end / 1e3, sent, (double)latest_ns / 1e3);
  fflush(stdout);
}

int main(int argc, char** argv) {
  double rate = 1000;
  int64_t unplug_after = -1;
  int64_t silent_ns = 0;
  int priority = 60;
  const char* script = NULL;
  for (int i = 1; i < argc; ++i) {
    if (!strcmp(argv[i], "--rate") && i + 1 < argc) {
      rate = atof(argv[++i]);
    } else if (!strcmp(argv[i], "--unplug-after") && i + 1 < argc) {
      unplug_after = atoll(argv[++i]);
    } else if (!strcmp(argv[i], "--silent") && i + 1 < argc) {
      silent_ns = 1000000 * (int64_t)atoll(argv[++i]);
    } else if (!strcmp(argv[i], "--priority") && i + 1 < argc) {
      priority = atoi(argv[++i]);
    } else {
      script = argv[i];
    }
  }
  if (!script || !(rate > 0)) {
    fputs(
        "usage: rawhid-device [--rate HZ] [--unplug-after N [--silent MS]] [--priority P] "
        "POSITIONS\n",
        stderr);
    return 2;
  }
  size_t count = 0;
  int32_t(*positions)[3] = read_positions(script, &count);
  const struct sched_param scheduling = {.sched_priority = priority};
  if (sched_setscheduler(0, SCHED_FIFO, &scheduling) != 0) die("SCHED_FIFO");
  sigset_t waiting;
  catch_term(&waiting);

  const int fd = uhid_create("Teensy RawHID", 0x16c0, 0x0486, descriptor, sizeof descriptor);
  static struct uhid_event event;
  int is_open = 0;
  int64_t sent = 0;
  int64_t latest_ns = 0;
  while (!ended) {
    const int all_sent = unplug_after >= 0 && sent >= unplug_after;
    /* Between two reports it listens. A time that passed while nobody had it open is left out. */
    const int64_t due =
        first_open + (int64_t)((double)sent * 1e9 / rate) + (all_sent ? silent_ns : 0);
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
      uhid_read(fd, &event);
      handle(&event, &is_open);
    }
  }
  if (unplug_after >= 0 && sent >= unplug_after) uhid_destroy(fd);
  print_record(sent, latest_ns);
  return 0;
}
