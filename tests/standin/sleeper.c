/* The hung ball with a slow C(), for tests and benchmarks. A conversion that sleeps needs no
 * processor, so that there can be more workers than processors; one that is busy needs one.
 *
 *   milliseconds         how long a conversion sleeps (0)
 *   busy_microseconds    how much processor time of its thread a conversion uses (0)
 *
 * The other parameters are the hung ball's, whose source is compiled into this plug-in under
 * another name (CMakeLists.txt).
 */
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <time.h>

#include "libcore/model/plugin.h"

const hapgrid_model_table* hung_ball_plugin(void);

/* All models of a process have the same parameters, so these are global. */
static double milliseconds;
static double busy_microseconds;

static double thread_microseconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static hapgrid_model* create(const hapgrid_parameter* parameters, size_t count, char* error,
                             size_t error_size) {
  hapgrid_parameter* others = malloc((count + 1) * sizeof *others);
  if (!others) return NULL;
  size_t used = 0;
  for (size_t i = 0; i < count; ++i) {
    const int is_number = parameters[i].type == HAPGRID_NUMBER;
    if (is_number && strcmp(parameters[i].key, "milliseconds") == 0)
      milliseconds = parameters[i].numbers[0];
    else if (is_number && strcmp(parameters[i].key, "busy_microseconds") == 0)
      busy_microseconds = parameters[i].numbers[0];
    else
      others[used++] = parameters[i];
  }
  hapgrid_model* model = hung_ball_plugin()->create(others, used, error, error_size);
  free(others);
  return model;
}

static int convert(hapgrid_model* model, const double* s, const double* x, const double* d,
                   double* result, char* error, size_t error_size) {
  if (milliseconds > 0) {
    const struct timespec pause = {(time_t)(milliseconds / 1e3),
                                   (long)(milliseconds * 1e6) % 1000000000};
    prctl(PR_SET_TIMERSLACK, 1); /* otherwise a sleep lasts up to 50 us longer */
    nanosleep(&pause, NULL);
  }
  if (busy_microseconds > 0) {
    const double end = thread_microseconds() + busy_microseconds;
    while (thread_microseconds() < end) continue;
  }
  return hung_ball_plugin()->convert(model, s, x, d, result, error, error_size);
}

const hapgrid_model_table* hapgrid_model_plugin(void) {
  static hapgrid_model_table table;
  table = *hung_ball_plugin();
  table.create = create;
  table.convert = convert;
  return &table;
}
