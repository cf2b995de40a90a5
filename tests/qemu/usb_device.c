/* usb-device: a stick of the PID class on USB, with the report descriptor kPidStick; vendor 2341,
 * product 8036. It hangs on the kernel's vhci_hcd (Documentation/usb/usbip_protocol.rst) by a
 * socket, so usbhid and hid-pidff drive it as they drive one on a cable.
 *
 * While an effect is there its X goes from the middle to the left end within 1.2 s; it says so
 * every 4 ms. It prints each report that it gets, at once: "TIME output|set BYTES", in hex, the id
 * first; TIME in microseconds since the start. */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>

#include "tests/hid/descriptors.h"
#include "tests/qemu/uhid.h"

enum { kSubmit = 1, kUnlink = 2, kSubmitted = 3, kUnlinked = 4, kIn = 1 };
enum { kCreate = 0x05, kLoad = 0x06, kPool = 0x07, kFree = 0x0b, kEffects = 4, kWayMs = 1200 };

/* 48 bytes, big-endian. */
struct message {
  uint32_t command, number, device, direction, endpoint;
  uint32_t word[5]; /* submit: flags, length, ...; submitted: status, length, ... */
  unsigned char setup[8];
};

static int wire;
static int64_t began, created;
static uint32_t waiting; /* number of the input transfer that waits, 0: none */
static int taken[kEffects + 1];
static unsigned char loaded[5] = {kLoad, 0, 3, 64, 0};

/* clang-format off */
static const unsigned char device_descriptor[18] = {
    18, 1, 0, 2, 0, 0, 0, 64, 0x41, 0x23, 0x36, 0x80, 0, 1, 0, 1, 0, 1,
};
static const unsigned char config_descriptor[41] = {
    9, 2, 41, 0, 1, 1, 0, 0x80, 50,
    9, 4, 0, 0, 2, 3, 0, 0, 0,
    9, 0x21, 0x11, 1, 0, 1, 0x22, sizeof kPidStick & 255, sizeof kPidStick >> 8,
    7, 5, 0x81, 3, 64, 0, 1,
    7, 5, 0x02, 3, 64, 0, 1,
};
/* clang-format on */

static void all(int receive, void* data, size_t size) {
  for (char* at = data; size > 0;) {
    const ssize_t n = receive ? recv(wire, at, size, 0) : send(wire, at, size, 0);
    if (n <= 0) die("the bus");
    at += n;
    size -= (size_t)n;
  }
}

static void answer(uint32_t command, uint32_t number, int status, const void* data, size_t size,
                   size_t length) {
  struct message reply = {.command = htonl(command), .number = htonl(number)};
  reply.word[0] = htonl((uint32_t)status);
  reply.word[1] = htonl((uint32_t)length);
  all(0, &reply, sizeof reply);
  if (size > 0) all(0, (void*)data, size);
}

static void say(const char* what, const unsigned char* bytes, size_t size) {
  printf("%lld %s", (long long)((now_ns() - began) / 1000), what);
  for (size_t i = 0; i < size; ++i) printf(" %02x", bytes[i]);
  puts("");
}

static void create(void) {
  loaded[1] = 0;
  loaded[2] = 2; /* full */
  for (unsigned char i = 1; i <= kEffects; ++i) {
    if (taken[i]) continue;
    taken[i] = 1;
    loaded[1] = i;
    loaded[2] = 1; /* success */
    created = now_ns();
    return;
  }
}

/* An output report. */
static void take(const unsigned char* bytes, size_t size) {
  say("output", bytes, size);
  if (bytes[0] != kFree || bytes[1] > kEffects) return;
  taken[bytes[1]] = 0;
  created = 0;
}

static void control(const struct message* m, const unsigned char* data, size_t length) {
  static const unsigned char text[4] = {4, 3, 9, 4},
                             name[12] = {12, 3, 's', 0, 't', 0, 'i', 0, 'c', 0, 'k'};
  static const unsigned char pool[5] = {kPool, 0, 4, kEffects, 1};
  const int request = m->setup[0] << 8 | m->setup[1];
  const unsigned char* bytes = NULL;
  size_t size = 0;
  const int kind = m->setup[3];
#define GIVE(what) bytes = what, size = sizeof what
  if (request == 0x8006 && kind == 1) GIVE(device_descriptor);
  if (request == 0x8006 && kind == 2) GIVE(config_descriptor);
  if (request == 0x8006 && kind == 3 && m->setup[2] == 0) GIVE(text);
  if (request == 0x8006 && kind == 3 && m->setup[2] != 0) GIVE(name);
  if (request == 0x8106 && kind == 0x22) GIVE(kPidStick);
  if (request == 0xa101 && m->setup[2] == kLoad) GIVE(loaded);
  if (request == 0xa101 && m->setup[2] == kPool) GIVE(pool);
  if (request == 0x2109 && kind == 2) { /* output */
    take(data, length);
  } else if (request == 0x2109) {
    say("set", data, length);
    if (m->setup[2] == kCreate) create();
  }
  if (m->setup[0] & 0x80) {
    if (size > length) size = length;
    answer(kSubmitted, ntohl(m->number), bytes ? 0 : -EPIPE, bytes, size, size);
  } else {
    answer(kSubmitted, ntohl(m->number), 0, NULL, 0, length);
  }
}

static void handle(void) {
  struct message m;
  unsigned char data[4096];
  all(1, &m, sizeof m);
  const uint32_t number = ntohl(m.number), length = ntohl(m.word[1]);
  if (ntohl(m.command) == kUnlink) {
    const int is_waiting = waiting != 0 && ntohl(m.word[0]) == waiting;
    if (is_waiting) waiting = 0;
    answer(kUnlinked, number, is_waiting ? -ECONNRESET : 0, NULL, 0, 0);
    return;
  }
  const int in = ntohl(m.direction) == kIn;
  if (length > sizeof data) die("the length of a transfer");
  if (!in) all(1, data, length);
  if (ntohl(m.endpoint) == 0) {
    control(&m, data, length);
  } else if (in) {
    waiting = number;
  } else {
    take(data, length);
    answer(kSubmitted, number, 0, NULL, 0, length);
  }
}

static void move(void) {
  const int64_t ms = created ? (now_ns() - created) / 1000000 : 0;
  const int16_t x = (int16_t)(ms < kWayMs ? -32767 * ms / kWayMs : -32767);
  const unsigned char report[6] = {3, 0, (unsigned char)x, (unsigned char)(x >> 8), 0, 0};
  const uint32_t number = waiting;
  waiting = 0;
  answer(kSubmitted, number, 0, report, sizeof report, sizeof report);
}

int main(void) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  began = now_ns();
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) die("socketpair");
  wire = ends[0];
  FILE* attach = fopen("/sys/devices/platform/vhci_hcd.0/attach", "w");
  /* Port, socket, number of the device, and 2: full speed. */
  if (!attach || fprintf(attach, "0 %d 65538 2\n", ends[1]) < 0 || fclose(attach) != 0)
    die("vhci_hcd");
  close(ends[1]);
  int64_t due = now_ns();
  for (;;) {
    struct pollfd ready = {.fd = wire, .events = POLLIN};
    const int64_t left = due - now_ns();
    if (poll(&ready, 1, left <= 0 ? 0 : (int)(left / 1000000) + 1) > 0) handle();
    if (now_ns() < due) continue;
    due = now_ns() + 4000000;
    if (waiting) move();
  }
}
