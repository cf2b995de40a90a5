// A stand-in for Force Dimension's libdhd: a device in process whose handle rests at one place. As
// with the real one, forces come after dhdEnableForce() alone, dhdStop() puts on the brakes, and
// calls for a device that is not open fail.
#include <dhdc.h>

#include "tests/standin/kits/kit.h"

static int open_, enabled;
static const char* error = "no error";

static int refuse(const char* why) {
  error = why;
  return -1;
}

int dhdOpen(void) {
  if (kit_fault("absent", 0)) return refuse("no device found");
  open_ = 1;
  return 0;
}

int dhdClose(char id) {
  if (!open_) return refuse("device is not open");
  open_ = 0;
  kit_note("closed");
  return 0;
}

int dhdStop(char id) {
  if (!open_) return refuse("device is not open");
  enabled = 0;
  kit_note("brakes");
  return 0;
}

int dhdEnableForce(uchar on, char id) {
  if (!open_) return refuse("device is not open");
  enabled = on == DHD_ON;
  return 0;
}

int dhdSetForce(double x, double y, double z, char id) {
  if (!open_ || !enabled) return refuse("device is not ready");
  if (!kit_force(x, y, z)) return refuse("communication error");
  return x * x + y * y + z * z > 0.1 ? DHD_MOTOR_SATURATED : 0;
}

// 25 mm to the left of the middle, 10 mm away from the user, 5 mm up.
int dhdGetPosition(double* x, double* y, double* z, char id) {
  if (!open_) return refuse("device is not open");
  *x = -0.010, *y = -0.025, *z = 0.005;
  return DHD_TIMEGUARD;
}

uint dhdGetButtonMask(char id) {
  return 2;  // the second button is held
}

const char* dhdGetSystemName(char id) { return "stand-in omega"; }

const char* dhdErrorGetLastStr(void) { return error; }
