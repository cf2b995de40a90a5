// What the stand-ins for makers' kits have in common. HAPGRID_KIT names a file that gets a line for
// each thing that the device hears: "force X Y Z" as the kit has its axes and units, "brakes",
// "closed".
//
// HAPGRID_KIT_FAULT is what the device does wrong: "absent"; or "hang N", "fail N" at its N-th
// force.
#ifndef HAPGRID_STANDIN_KIT_H
#define HAPGRID_STANDIN_KIT_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static inline void kit_note(const char* text) {
  static FILE* file;
  if (!file) file = fopen(getenv("HAPGRID_KIT"), "a");
  fprintf(file, "%s\n", text);
  fflush(file);
}

static inline int kit_fault(const char* name, long forces) {
  const char* fault = getenv("HAPGRID_KIT_FAULT");
  const size_t length = strlen(name);
  return fault && strncmp(fault, name, length) == 0 && forces >= atol(fault + length);
}

// Whether this force fails; notes it otherwise.
static inline int kit_force(double x, double y, double z) {
  static long forces;
  static double last[3];
  ++forces;
  if (kit_fault("fail", forces)) return 0;
  if (forces == 1 || x != last[0] || y != last[1] || z != last[2]) {
    char text[128];
    snprintf(text, sizeof text, "force %.6g %.6g %.6g", x, y, z);
    kit_note(text);
  }
  last[0] = x, last[1] = y, last[2] = z;
  while (kit_fault("hang", forces)) sleep(1);
  return 1;
}

#endif
