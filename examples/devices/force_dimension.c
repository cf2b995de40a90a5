/* An adapter to the devices of Force Dimension (omega, delta, sigma, lambda; the Falcon, too),
 * through their SDK.
 *
 *     play my.grid --device 'process:build/devices/force-dimension [REACH [NEWTONS]]'
 *
 * The SDK does not say how far a device reaches and what it can hold. REACH in metres (0.05) and
 * NEWTONS (8) suit a Falcon and an omega. The device must be calibrated. Forces come on top of the
 * SDK's gravity compensation.
 *
 * The SDK's x points to the user, y to the right, z up. */
#include <dhdc.h>
#include <stdlib.h>

#include "examples/devices/adapter.h"

static int fail(const char* what) {
  const int code = complain(what, dhdErrorGetLastStr());
  dhdStop(-1); /* brakes, whatever the force was */
  dhdClose(-1);
  return code;
}

/* Brakes, whatever the force was. */
static int release(void) {
  if (dhdOpen() < 0) return complain("no device", dhdErrorGetLastStr());
  const int code = dhdStop(-1) < 0 ? complain("cannot brake", dhdErrorGetLastStr()) : 0;
  dhdClose(-1);
  return code;
}

int main(int count, char** words) {
  if (is_release(&count, words)) return release();
  const double reach = count > 1 ? atof(words[1]) : 0.05, newtons = count > 2 ? atof(words[2]) : 8;
  if (dhdOpen() < 0) return complain("no device", dhdErrorGetLastStr());
  if (dhdEnableForce(DHD_ON, -1) < 0) return fail("cannot enable forces");
  const hapgrid_device_greeting hello = greeting(dhdGetSystemName(-1), reach, newtons, 4000);
  say(&hello, sizeof hello);

  hapgrid_device_force f;
  do {
    const int answer = next_force(&f);
    double x, y, z;
    if (dhdSetForce(-f.force[1], f.force[0], f.force[2], -1) < 0) return fail("cannot set a force");
    if (dhdGetPosition(&x, &y, &z, -1) < 0) return fail("cannot read the position");
    const hapgrid_device_state state = {.time = now(),
                                        .position = {y, -x, z},
                                        .flags = flags_of(dhdGetButtonMask(-1)),
                                        .number = f.number};
    if (answer) say(&state, sizeof state);
  } while (!(f.flags & HAPGRID_DEVICE_END));
  dhdStop(-1);
  dhdClose(-1);
  return 0;
}
