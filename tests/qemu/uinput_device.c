/* uinput-device gamepad|stick [--slow N]: an event device with effects, made by the kernel's
 * uinput.
 *
 * gamepad has X, Y, Rx, Ry, two buttons and FF_RUMBLE; stick X, Y, two buttons and FF_CONSTANT.
 * When an effect is created, the gamepad's X goes to its left end after 0.1 s; the stick's X goes
 * there from the middle within 1.2 s. When the last effect is erased, it goes back to the middle.
 * SIGUSR1 holds the second button for 50 ms. With --slow it takes no effect any more after N of
 * them.
 *
 * What happens goes to standard output at once, a line each, with the microseconds of
 * CLOCK_MONOTONIC:
 *
 *   TIME upload ID rumble STRONG WEAK LENGTH | TIME upload ID constant LEVEL DIRECTION LENGTH
 *   TIME erase ID | TIME play ID TIMES | TIME set CODE VALUE */
#define _GNU_SOURCE
#include <linux/input.h>
#include <linux/uinput.h>
#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>

#include "tests/qemu/device.h"

enum { kHalf = 32767, kStepMs = 4, kWayMs = 1200, kPauseMs = 100, kHoldMs = 50 };

static int fd, is_stick, effects, uploads, most_uploads = -1;
static int64_t created, pressed;
static volatile sig_atomic_t to_press;

static void say(const char* what) { printf("%lld %s", (long long)(now_ns() / 1000), what); }

static void need(int result, const char* what) {
  if (result < 0) die(what);
}

static void emit(int type, int code, int value) {
  const struct input_event event = {.type = (uint16_t)type, .code = (uint16_t)code, .value = value};
  need((int)write(fd, &event, sizeof event), "event");
}

static void axis(int code, int flat) {
  const struct uinput_abs_setup setup = {
      .code = (uint16_t)code, .absinfo = {.minimum = -kHalf, .maximum = kHalf, .flat = flat}};
  need(ioctl(fd, UI_ABS_SETUP, &setup), "axis");
}

static int second_button(void) { return is_stick ? BTN_THUMB : BTN_EAST; }

static void create(void) {
  struct uinput_setup setup = {
      .id = {BUS_USB, is_stick ? 0x1209 : 0x045e, is_stick ? 0x0001 : 0x028e, 1},
      .ff_effects_max = 16};
  snprintf(setup.name, sizeof setup.name, "emulated %s", is_stick ? "stick" : "gamepad");
  fd = open("/dev/uinput", O_RDWR | O_CLOEXEC);
  need(fd, "/dev/uinput");
  const int types[] = {EV_ABS, EV_KEY, EV_FF};
  for (unsigned i = 0; i < 3; ++i) need(ioctl(fd, UI_SET_EVBIT, types[i]), "types");
  need(ioctl(fd, UI_SET_KEYBIT, is_stick ? BTN_TRIGGER : BTN_SOUTH), "button");
  need(ioctl(fd, UI_SET_KEYBIT, second_button()), "button");
  need(ioctl(fd, UI_SET_FFBIT, is_stick ? FF_CONSTANT : FF_RUMBLE), "effect");
  need(ioctl(fd, UI_SET_FFBIT, FF_GAIN), "gain");
  if (is_stick) need(ioctl(fd, UI_SET_FFBIT, FF_AUTOCENTER), "autocentre");
  axis(ABS_X, is_stick ? 0 : 128);
  axis(ABS_Y, is_stick ? 0 : 128);
  if (!is_stick) axis(ABS_RX, 128);
  if (!is_stick) axis(ABS_RY, 128);
  need(ioctl(fd, UI_DEV_SETUP, &setup), "device");
  need(ioctl(fd, UI_DEV_CREATE), "device");
}

static void upload(int request) {
  if (most_uploads >= 0 && ++uploads > most_uploads) return;
  struct uinput_ff_upload up = {.request_id = (uint32_t)request};
  need(ioctl(fd, UI_BEGIN_FF_UPLOAD, &up), "upload");
  const struct ff_effect* effect = &up.effect;
  if (up.old.type == 0 && effects++ == 0) created = now_ns();
  say("upload ");
  if (effect->type == FF_RUMBLE)
    printf("%d rumble %d %d", effect->id, effect->u.rumble.strong_magnitude,
           effect->u.rumble.weak_magnitude);
  else
    printf("%d constant %d %d", effect->id, effect->u.constant.level, effect->direction);
  printf(" %d\n", effect->replay.length);
  need(ioctl(fd, UI_END_FF_UPLOAD, &up), "upload");
}

static void erase(int request) {
  struct uinput_ff_erase gone = {.request_id = (uint32_t)request};
  need(ioctl(fd, UI_BEGIN_FF_ERASE, &gone), "erase");
  --effects;
  say("erase ");
  printf("%d\n", (int)gone.effect_id);
  need(ioctl(fd, UI_END_FF_ERASE, &gone), "erase");
}

static void handle(void) {
  struct input_event event;
  need((int)read(fd, &event, sizeof event), "read");
  if (event.type == EV_UINPUT && event.code == UI_FF_UPLOAD) upload(event.value);
  if (event.type == EV_UINPUT && event.code == UI_FF_ERASE) erase(event.value);
  if (event.type != EV_FF) return;
  say(event.code >= FF_GAIN ? "set " : "play ");
  printf("%d %d\n", event.code, event.value);
}

static int place(void) {
  if (effects == 0) return 0;
  const int64_t ms = (now_ns() - created) / 1000000;
  if (!is_stick) return ms < kPauseMs ? 0 : -kHalf;
  return ms < kWayMs ? (int)(-kHalf * ms / kWayMs) : -kHalf;
}

static void on_signal(int number) {
  (void)number;
  to_press = 1;
}

/* Presses the second button where that is wanted, and lets it go when it was held. */
static void press(void) {
  const int is_over = pressed != 0 && now_ns() - pressed > kHoldMs * 1000000LL;
  if (!to_press && !is_over) return;
  emit(EV_KEY, second_button(), to_press);
  emit(EV_SYN, SYN_REPORT, 0);
  pressed = to_press ? now_ns() : 0;
  to_press = 0;
}

int main(int argc, char** argv) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  is_stick = argc > 1 && strcmp(argv[1], "stick") == 0;
  if (argc > 3 && strcmp(argv[2], "--slow") == 0) most_uploads = atoi(argv[3]);
  signal(SIGUSR1, on_signal);
  create();
  for (int last = 0;;) {
    struct pollfd ready = {.fd = fd, .events = POLLIN};
    if (poll(&ready, 1, kStepMs) > 0) handle();
    press();
    const int now = place();
    if (now == last) continue;
    emit(EV_ABS, ABS_X, last = now);
    emit(EV_SYN, SYN_REPORT, 0);
  }
}
