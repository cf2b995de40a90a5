/* pid-device: a joystick of the PID class with two axes and the report descriptor kPidBits of
 * tests/hid/descriptors.h; vendor 1209, product ffb0. It has room for two effects: each Create New
 * Effect takes a block, Block Load says which (or that there is none), Block Free gives it back.
 *
 * Its stick is at x = 16384, y = -8192 of +-32767, and says so 100 times a second while it is open.
 *
 * SIGTERM ends it and prints the record: a line for each report that came or was asked for, "TIME
 * output|set|get BYTES", TIME in microseconds after the first line, BYTES in hex with the id first.
 * The bytes of a get are the answer. */
#define _GNU_SOURCE
#include <poll.h>

#include "tests/hid/descriptors.h"
#include "tests/qemu/uhid.h"

enum { kEffects = 2, kRoom = 4096 };

/* Report ids. */
enum { kInput = 0x01, kCreate = 0x11, kLoad = 0x12, kPool = 0x13, kBlockFree = 0x0b };

static struct {
  int64_t time_ns;
  const char* what;
  unsigned char bytes[32];
  size_t size;
} records[kRoom];
static size_t record_count;

static void record(const char* what, const unsigned char* bytes, size_t size) {
  if (record_count == kRoom) return;
  records[record_count].time_ns = now_ns();
  records[record_count].what = what;
  records[record_count].size = size < 32 ? size : 32;
  memcpy(records[record_count].bytes, bytes, records[record_count].size);
  ++record_count;
}

static int taken[kEffects + 1]; /* blocks are numbered from 1 */
static unsigned char block_load[2] = {0, 3};

static void create_effect(void) {
  block_load[0] = 0;
  block_load[1] = 2; /* full */
  for (int i = 1; i <= kEffects; ++i) {
    if (taken[i]) continue;
    taken[i] = 1;
    block_load[0] = (unsigned char)i;
    block_load[1] = 1; /* success */
    break;
  }
}

static void handle(int fd, struct uhid_event* event, int* is_open) {
  static struct uhid_event reply;
  memset(&reply, 0, sizeof reply);
  if (event->type == UHID_OPEN || event->type == UHID_CLOSE) *is_open = event->type == UHID_OPEN;
  if (event->type == UHID_OUTPUT) {
    const unsigned char* data = event->u.output.data;
    record("output", data, event->u.output.size);
    if (data[0] == kBlockFree && data[1] <= kEffects) taken[data[1]] = 0;
  }
  if (event->type == UHID_SET_REPORT) {
    record("set", event->u.set_report.data, event->u.set_report.size);
    if (event->u.set_report.rtype == UHID_FEATURE_REPORT && event->u.set_report.rnum == kCreate)
      create_effect();
    reply.type = UHID_SET_REPORT_REPLY;
    reply.u.set_report_reply.id = event->u.set_report.id;
    uhid_send(fd, &reply);
  }
  if (event->type == UHID_GET_REPORT) {
    unsigned char bytes[5] = {event->u.get_report.rnum};
    reply.type = UHID_GET_REPORT_REPLY;
    reply.u.get_report_reply.id = event->u.get_report.id;
    if (event->u.get_report.rtype == UHID_FEATURE_REPORT &&
        event->u.get_report.rnum == kLoad) { /* index, status, room */
      memcpy(bytes + 1, block_load, 2);
      bytes[3] = 64;
    } else if (event->u.get_report.rtype == UHID_FEATURE_REPORT &&
               event->u.get_report.rnum == kPool) { /* size, effects, device managed */
      bytes[1] = 128;
      bytes[3] = kEffects;
      bytes[4] = 1;
    } else {
      reply.u.get_report_reply.err = EIO;
    }
    reply.u.get_report_reply.size = sizeof bytes;
    memcpy(reply.u.get_report_reply.data, bytes, sizeof bytes);
    record("get", bytes, sizeof bytes);
    uhid_send(fd, &reply);
  }
}

int main(void) {
  sigset_t waiting;
  catch_term(&waiting);
  const int fd = uhid_create("PID joystick", 0x1209, 0xffb0, kPidBits, sizeof kPidBits);
  static struct uhid_event event;
  int is_open = 0;
  int64_t due = now_ns();
  while (!ended) {
    const int64_t left = due - now_ns();
    if (is_open && left <= 0) {
      const unsigned char report[6] = {kInput, 0, 0x00, 0x40, 0x00, 0xe0};
      uhid_input(fd, report, sizeof report);
      due += 10000000;
      continue;
    }
    if (!is_open) due = now_ns();
    const struct timespec timeout = {left / 1000000000, left % 1000000000};
    struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
    if (ppoll(&poll_fd, 1, is_open ? &timeout : NULL, &waiting) > 0) {
      uhid_read(fd, &event);
      handle(fd, &event, &is_open);
    }
  }
  for (size_t i = 0; i < record_count; ++i) {
    printf("%.3f %s", (double)(records[i].time_ns - records[0].time_ns) / 1e3, records[i].what);
    for (size_t j = 0; j < records[i].size; ++j) printf(" %02x", records[i].bytes[j]);
    puts("");
  }
  fflush(stdout);
  return 0;
}
