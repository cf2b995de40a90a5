// What the adapter to Force Dimension's devices uses of their SDK, for the stand-in dhd.c.
#ifndef HAPGRID_STANDIN_DHDC_H
#define HAPGRID_STANDIN_DHDC_H

#define DHD_ON 1
#define DHD_TIMEGUARD 1        // positions: the last one is fresh enough; no error
#define DHD_MOTOR_SATURATED 2  // forces: some motor gives all it can; no error

typedef unsigned char uchar;
typedef unsigned int uint;

int dhdOpen(void);
int dhdClose(char id);
int dhdStop(char id);
int dhdEnableForce(uchar on, char id);
int dhdSetForce(double x, double y, double z, char id);
int dhdGetPosition(double* x, double* y, double* z, char id);
uint dhdGetButtonMask(char id);
const char* dhdGetSystemName(char id);
const char* dhdErrorGetLastStr(void);

#endif
