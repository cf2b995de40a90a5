// A stand-in for libhidapi-hidraw.so.0: the real programs run, and their device is a process of the
// test's, which can be as slow, short, or gone as a test needs it.
//
// HAPGRID_STANDIN names a Unix socket (SOCK_SEQPACKET) where the device process listens. Each
// message is a letter and its content; numbers are the machine's own int32.
//
//   to list, one connection:
//     "L"            <-  a line for each collection: path, vid, pid, serial, manufacturer, product,
//                        usage page, usage, interface, with tabs between them; numbers in hex, the
//                        interface decimal; all in one message
//   a handle, two connections:
//     "I" path       only listened to:
//                    <-  "i" report    an input report
//                    <-  "e" text      hid_read fails, with this error
//     "C" path       <-  "k", or "e" text: it cannot be opened
//     "w" report     <-  "r" n [text]  what hid_write answers; hid_write waits for it
//     "f" report     <-  "r" n [text]  hid_send_feature_report
//
// A connection that the device process closes is an unplugged device.
#define _GNU_SOURCE
#include <hidapi/hidapi.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { kMaxMessage = 8192 };

struct hid_device_ {
  int input, control;
  wchar_t error[256];
};

static wchar_t open_error[256];

static void set_error(wchar_t* error, const char* text) {
  size_t i = 0;
  for (; text[i] && i < 255; ++i) error[i] = (unsigned char)text[i];
  error[i] = 0;
}

static int dial(char letter, const char* path) {
  const char* name = getenv("HAPGRID_STANDIN");
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  if (!name || strlen(name) >= sizeof address.sun_path) return -1;
  strcpy(address.sun_path, name);
  const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  char hello[512];
  const int size = snprintf(hello, sizeof hello, "%c%s", letter, path);
  if (connect(fd, (struct sockaddr*)&address, sizeof address) != 0 ||
      send(fd, hello, (size_t)size, MSG_NOSIGNAL) != size) {
    close(fd);
    return -1;
  }
  return fd;
}

hid_device* hid_open_path(const char* path) {
  hid_device* device = calloc(1, sizeof *device);
  char answer[256] = "eno device process";
  device->input = dial('I', path);
  device->control = dial('C', path);
  if (device->input >= 0 && device->control >= 0) {
    const ssize_t got = recv(device->control, answer, sizeof answer - 1, 0);
    if (got == 1 && answer[0] == 'k') return device;
    if (got > 0) answer[got] = 0;
  }
  set_error(open_error, answer + 1);
  hid_close(device);
  return NULL;
}

void hid_close(hid_device* device) {
  if (!device) return;
  if (device->input >= 0) close(device->input);
  if (device->control >= 0) close(device->control);
  free(device);
}

int hid_read_timeout(hid_device* device, unsigned char* data, size_t length, int milliseconds) {
  struct pollfd ready = {device->input, POLLIN, 0};
  static __thread char message[kMaxMessage];
  if (poll(&ready, 1, milliseconds) <= 0) return 0;
  const ssize_t got = recv(device->input, message, sizeof message - 1, 0);
  message[got > 0 ? got : 0] = 0;
  if (got <= 0 || message[0] == 'e') {
    set_error(device->error, got <= 0 ? "device disconnected" : message + 1);
    return -1;
  }
  const size_t size = (size_t)got - 1 < length ? (size_t)got - 1 : length;
  memcpy(data, message + 1, size);
  return (int)size;
}

static int ask(hid_device* device, char letter, const unsigned char* data, size_t size) {
  static __thread char message[kMaxMessage];
  int32_t n = -1;
  if (size < sizeof message) {
    message[0] = letter;
    memcpy(message + 1, data, size);
    if (send(device->control, message, size + 1, MSG_NOSIGNAL) >= 0) {
      const ssize_t got = recv(device->control, message, sizeof message - 1, 0);
      if (got >= 5) {
        message[got] = 0;
        memcpy(&n, message + 1, sizeof n);
        set_error(device->error, n < 0 ? message + 5 : "Success");
        return n;
      }
    }
  }
  set_error(device->error, "device disconnected");
  return -1;
}

int hid_write(hid_device* device, const unsigned char* data, size_t length) {
  return ask(device, 'w', data, length);
}
int hid_send_feature_report(hid_device* device, const unsigned char* data, size_t length) {
  return ask(device, 'f', data, length);
}
const wchar_t* hid_error(hid_device* device) { return device ? device->error : open_error; }

static wchar_t* wide(const char* text) {
  wchar_t* copy = calloc(256, sizeof *copy);
  set_error(copy, text);
  return copy;
}

struct hid_device_info* hid_enumerate(unsigned short vid, unsigned short pid) {
  static char list[kMaxMessage];
  const int fd = dial('L', "");
  if (fd < 0) return NULL;
  const ssize_t got = recv(fd, list, sizeof list - 1, 0);
  close(fd);
  if (got <= 0) return NULL;
  list[got] = 0;
  struct hid_device_info* first = NULL;
  struct hid_device_info** last = &first;
  char* rest = list;
  for (char* line; (line = strsep(&rest, "\n")) && *line;) {
    const char* field[9];
    for (int i = 0; i < 9; ++i) {
      field[i] = strsep(&line, "\t");
      if (!field[i]) field[i] = "";
    }
    const unsigned short v = (unsigned short)strtoul(field[1], NULL, 16);
    const unsigned short p = (unsigned short)strtoul(field[2], NULL, 16);
    if ((vid && vid != v) || (pid && pid != p)) continue;
    struct hid_device_info* info = calloc(1, sizeof *info);
    info->path = strdup(field[0]);
    info->vendor_id = v;
    info->product_id = p;
    info->serial_number = wide(field[3]);
    info->manufacturer_string = wide(field[4]);
    info->product_string = wide(field[5]);
    info->usage_page = (unsigned short)strtoul(field[6], NULL, 16);
    info->usage = (unsigned short)strtoul(field[7], NULL, 16);
    info->interface_number = atoi(field[8]);
    *last = info;
    last = &info->next;
  }
  return first;
}

void hid_free_enumeration(struct hid_device_info* info) {
  while (info) {
    struct hid_device_info* next = info->next;
    free(info->path);
    free(info->serial_number);
    free(info->manufacturer_string);
    free(info->product_string);
    free(info);
    info = next;
  }
}
