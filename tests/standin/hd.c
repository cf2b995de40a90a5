// A stand-in for OpenHaptics' libHD: a device in process whose handle rests at one place. As with
// the real one, a thread of the kit calls back a thousand times a second once the scheduler runs;
// forces are set inside a frame and go out at its end, if force output is enabled; a force beyond
// the largest is an error and does not go out; hdGetError() takes the last error away; when the
// scheduler stops, so do forces.
#include <HD/hd.h>
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

#include "tests/standin/kits/kit.h"

static _Atomic HDerror last_error;
static int enabled, in_frame;
static double wanted[3];
static HDSchedulerCallback callback;
static pthread_t thread;
static atomic_int running;

HDErrorInfo hdGetError(void) {
  return (HDErrorInfo){.errorCode = atomic_exchange(&last_error, HD_SUCCESS)};
}

HDstring hdGetErrorString(HDerror code) {
  return code == HD_COMM_ERROR           ? "communication error"
         : code == HD_EXCEEDED_MAX_FORCE ? "exceeded the largest force"
                                         : "call outside of a frame";
}

HHD hdInitDevice(HDstring name) {
  if (kit_fault("absent", 0)) last_error = HD_COMM_ERROR;
  return 1;
}

void hdDisableDevice(HHD device) { kit_note("closed"); }

void hdEnable(HDenum what) { enabled |= what == HD_FORCE_OUTPUT; }

void hdBeginFrame(HHD device) { in_frame = 1; }

void hdEndFrame(HHD device) {
  in_frame = 0;
  const double squared = wanted[0] * wanted[0] + wanted[1] * wanted[1] + wanted[2] * wanted[2];
  if (squared > 0.88 * 0.88)
    last_error = HD_EXCEEDED_MAX_FORCE;
  else if (enabled && !kit_force(wanted[0], wanted[1], wanted[2]))
    last_error = HD_COMM_ERROR;
}

// 25 mm to the left of the middle, 10 mm away from the user, 5 mm up.
void hdGetDoublev(HDenum what, HDdouble* values) {
  static const double place[3] = {-25, 5, -10}, box[6] = {-50, -40, -30, 50, 40, 30};
  if (what == HD_MAX_WORKSPACE_DIMENSIONS) {
    memcpy(values, box, sizeof box);
  } else if (what == HD_NOMINAL_MAX_CONTINUOUS_FORCE) {
    *values = 0.88;
  } else if (!in_frame) {
    last_error = HD_FRAME_ERROR;
  } else if (what == HD_CURRENT_POSITION) {
    memcpy(values, place, sizeof place);
  } else {
    memset(values, 0, 3 * sizeof *values);
  }
}

void hdGetIntegerv(HDenum what, HDint* values) {
  *values = 2;  // the second button is held
}

void hdSetDoublev(HDenum what, const HDdouble* values) {
  if (what != HD_CURRENT_FORCE || !in_frame)
    last_error = HD_FRAME_ERROR;
  else
    memcpy(wanted, values, sizeof wanted);
}

HDstring hdGetString(HDenum what) { return "stand-in Touch"; }

static void* loop(void* unused) {
  const struct timespec tick = {.tv_nsec = 1000000};
  while (running && callback(NULL) == HD_CALLBACK_CONTINUE) nanosleep(&tick, NULL);
  return NULL;
}

HDSchedulerHandle hdScheduleAsynchronous(HDSchedulerCallback function, void* argument,
                                         HDushort priority) {
  callback = function;
  return 1;
}

void hdUnschedule(HDSchedulerHandle handle) {}

void hdStartScheduler(void) {
  running = 1;
  if (pthread_create(&thread, NULL, loop, NULL) != 0) last_error = HD_COMM_ERROR;
}

void hdStopScheduler(void) {
  running = 0;
  pthread_join(thread, NULL);
  kit_note("brakes");
}
