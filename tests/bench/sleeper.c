/* The hung ball with a C() that takes its time and no processor: for measuring what hands the
 * shards out (tests/bench/scaling/run.sh), with more workers than there are processors.
 *
 *   milliseconds    a conversion takes at least this long (0)
 *
 * and the parameters of the hung ball, whose source is compiled into this plug-in under another
 * name (CMakeLists.txt).
 */
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <time.h>

#include "libcore/model/plugin.h"

const hapgrid_model_table* hung_ball_plugin(void);

/* The same for all models of a process, which have the same parameters. */
static double milliseconds;

static hapgrid_model* create(const hapgrid_parameter* parameters, size_t count, char* error,
                             size_t error_size) {
  hapgrid_parameter* others = malloc((count + 1) * sizeof *others);
  if (!others) return NULL;
  size_t used = 0;
  for (size_t i = 0; i < count; ++i) {
    if (strcmp(parameters[i].key, "milliseconds") == 0 && parameters[i].type == HAPGRID_NUMBER)
      milliseconds = parameters[i].numbers[0];
    else
      others[used++] = parameters[i];
  }
  hapgrid_model* model = hung_ball_plugin()->create(others, used, error, error_size);
  free(others);
  return model;
}

static int convert(hapgrid_model* model, const double* s, const double* x, const double* d,
                   double* result, char* error, size_t error_size) {
  const struct timespec pause = {(time_t)(milliseconds / 1e3),
                                 (long)(milliseconds * 1e6) % 1000000000};
  prctl(PR_SET_TIMERSLACK, 1); /* of this thread: 50 us otherwise */
  nanosleep(&pause, NULL);
  return hung_ball_plugin()->convert(model, s, x, d, result, error, error_size);
}

const hapgrid_model_table* hapgrid_model_plugin(void) {
  static hapgrid_model_table table;
  table = *hung_ball_plugin();
  table.create = create;
  table.convert = convert;
  return &table;
}
