/* An adapter to the devices of 3D Systems (Touch, Touch X, Phantom), through OpenHaptics.
 *
 *     play my.grid --device 'process:build/devices/openhaptics [NAME]'     (NAME: of the device;
 * the default one)
 *
 * The kit calls back from a thread of its own, a thousand times a second. The callback takes the
 * newest force and leaves the newest state; a state's time is that of its callback, so that play
 * notices when none comes any more.
 *
 * The kit's lengths are millimetres; its y points up, z to the user. */
#include <HD/hd.h>
#include <pthread.h>

#include "examples/devices/adapter.h"

static struct {
  pthread_mutex_t mutex;
  HHD device;
  double force[3];
  hapgrid_device_state state;
  unsigned long served; /* callbacks */
  HDErrorInfo error;
} shared = {.mutex = PTHREAD_MUTEX_INITIALIZER};

static HDCallbackCode HDCALLBACK serve(void* unused) {
  (void)unused;
  HDdouble p[3], f[3];
  HDint buttons = 0;
  pthread_mutex_lock(&shared.mutex);
  memcpy(f, shared.force, sizeof f);
  pthread_mutex_unlock(&shared.mutex);
  const HDdouble turned[3] = {f[0], f[2], -f[1]};
  hdBeginFrame(shared.device);
  hdGetDoublev(HD_CURRENT_POSITION, p);
  hdGetIntegerv(HD_CURRENT_BUTTONS, &buttons);
  hdSetDoublev(HD_CURRENT_FORCE, turned);
  hdEndFrame(shared.device);
  const HDErrorInfo error = hdGetError();
  pthread_mutex_lock(&shared.mutex);
  shared.state = (hapgrid_device_state){.time = now(),
                                        .position = {p[0] / 1000, -p[2] / 1000, p[1] / 1000},
                                        .flags = flags_of((unsigned long)buttons)};
  if (HD_DEVICE_ERROR(error)) shared.error = error;
  ++shared.served;
  pthread_mutex_unlock(&shared.mutex);
  return HD_CALLBACK_CONTINUE;
}

/* Waits until the force that is set now is on the device: a callback that was under way may have
 * taken an older one. Returns whether that was soon. */
static int applied(void) {
  const double deadline = now() + HAPGRID_DEVICE_SILENCE;
  unsigned long begin = 0, served = 0;
  for (int first = 1; first || (served < begin + 2 && now() < deadline); first = 0) {
    if (!first) usleep(200);
    pthread_mutex_lock(&shared.mutex);
    served = shared.served;
    pthread_mutex_unlock(&shared.mutex);
    if (first) begin = served;
  }
  return served >= begin + 2;
}

static int play(void) {
  hapgrid_device_force f;
  do {
    const int answer = next_force(&f);
    pthread_mutex_lock(&shared.mutex);
    memcpy(shared.force, f.force, sizeof shared.force);
    hapgrid_device_state state = shared.state;
    const HDErrorInfo error = shared.error;
    pthread_mutex_unlock(&shared.mutex);
    if (HD_DEVICE_ERROR(error))
      return complain("the device failed", hdGetErrorString(error.errorCode));
    state.number = f.number;
    if ((f.flags & HAPGRID_DEVICE_END) && !applied())
      return complain("the device failed", "it took no zero force");
    if (answer) say(&state, sizeof state);
  } while (!(f.flags & HAPGRID_DEVICE_END));
  return 0;
}

int main(int count, char** words) {
  const int releases = is_release(&count, words);
  HDErrorInfo error;
  shared.device = hdInitDevice(count > 1 ? words[1] : HD_DEFAULT_DEVICE);
  if (HD_DEVICE_ERROR(error = hdGetError()))
    return complain("no device", hdGetErrorString(error.errorCode));
  HDdouble box[6], newtons = 0; /* mm: low x, y, z, high x, y, z */
  hdGetDoublev(HD_MAX_WORKSPACE_DIMENSIONS, box);
  hdGetDoublev(HD_NOMINAL_MAX_CONTINUOUS_FORCE, &newtons);
  hapgrid_device_greeting hello = greeting(hdGetString(HD_DEVICE_MODEL_TYPE), 0, newtons, 1000);
  const double low[3] = {box[0], -box[5], box[1]}, high[3] = {box[3], -box[2], box[4]};
  for (int a = 0; a < 3; ++a) {
    hello.low[a] = low[a] / 1000;
    hello.high[a] = high[a] / 1000;
  }
  hdEnable(HD_FORCE_OUTPUT);
  const HDSchedulerHandle loop = hdScheduleAsynchronous(serve, NULL, HD_MAX_SCHEDULER_PRIORITY);
  hdStartScheduler();
  int code = 1;
  if (HD_DEVICE_ERROR(error = hdGetError()))
    complain("no scheduler", hdGetErrorString(error.errorCode));
  else if (!applied())
    complain("no scheduler", "it calls nobody");
  else if (releases)
    code = 0; /* the kit has sent zero force */
  else if (say(&hello, sizeof hello))
    code = play();
  hdStopScheduler(); /* which takes the force away */
  hdUnschedule(loop);
  hdDisableDevice(shared.device);
  return code;
}
