/* A plug-in whose models share data, as those of some engines do: a spring whose work space is one for all models. With
 * CRASHES it ends as an engine does whose invariants are hurt. */
#include <hapgrid/plugin.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static volatile double shared;
static volatile int is_busy;

static hapgrid_model* create(const hapgrid_parameter* parameters, size_t count, char* error, size_t error_size) {
  (void)parameters, (void)count, (void)error, (void)error_size;
  return malloc(1);
}
static void destroy(hapgrid_model* model) { free(model); }
static void info(const hapgrid_model* model, hapgrid_model_info* info) {
  (void)model;
  info->state_size = 1;
  info->d_max = 10;
  info->tolerance = 1e-6;
#ifdef PROCESSES
  info->processes = PROCESSES;
#endif
}
static int known_states(hapgrid_model* model, const double* x, double* states, size_t capacity, size_t* count,
                        char* error, size_t error_size) {
  (void)model, (void)error, (void)error_size;
  *count = 1;
  if (capacity > 0) states[0] = x[0] / 2;
  return 0;
}
static int convert(hapgrid_model* model, const double* s, const double* x, const double* d, double* result,
                   char* error, size_t error_size) {
  const struct timespec pause = {0, 200000}; /* another thread comes in between */
  (void)model, (void)s, (void)error, (void)error_size;
#ifdef CRASHES
  if (is_busy) abort();
#endif
  is_busy = 1;
  shared = (x[0] + d[0]) / 2;
  nanosleep(&pause, NULL);
  *result = shared;
  is_busy = 0;
  return 0;
}
static int equal(const hapgrid_model* model, const double* a, const double* b) {
  (void)model;
  return *a - *b <= 1e-6 && *b - *a <= 1e-6;
}
static void force(hapgrid_model* model, const double* x, const double* s, double* f) {
  (void)model;
  f[0] = *s - x[0], f[1] = -x[1], f[2] = -x[2];
}

const hapgrid_model_table* hapgrid_model_plugin(void) {
  static hapgrid_model_table table;
  table.interface_version = HAPGRID_MODEL_INTERFACE;
  table.summary = "a spring whose models share data";
  table.create = create, table.destroy = destroy, table.info = info, table.known_states = known_states;
  table.convert = convert, table.equal = equal, table.force = force;
  return &table;
}
