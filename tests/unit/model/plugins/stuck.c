/* One state everywhere, and a force of half a newton along x, until the HIP is beyond x = 0.5: there
 * force() never comes back, or with `crash` other than 0 it aborts. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "libcore/model/plugin.h"

struct hapgrid_model {
  int crash;
};

static hapgrid_model* create(const hapgrid_parameter* list, size_t count, char* error,
                             size_t error_size) {
  (void)error, (void)error_size;
  hapgrid_model* model = calloc(1, sizeof *model);
  for (size_t i = 0; model && i < count; ++i)
    if (strcmp(list[i].key, "crash") == 0) model->crash = list[i].numbers[0] != 0;
  return model;
}

static void destroy(hapgrid_model* model) { free(model); }

static void info(const hapgrid_model* model, hapgrid_model_info* info) {
  (void)model;
  memset(info, 0, sizeof *info);
  info->state_size = 1;
  info->d_max = 10;
  info->force_scale = 1;
}

static int known_states(hapgrid_model* model, const double* x, double* states, size_t capacity,
                        size_t* count, char* error, size_t error_size) {
  (void)model, (void)x, (void)error, (void)error_size;
  if (capacity > 0) states[0] = 0;
  *count = 1;
  return 0;
}

static int convert(hapgrid_model* model, const double* s, const double* x, const double* d,
                   double* result, char* error, size_t error_size) {
  (void)model, (void)s, (void)x, (void)d, (void)error, (void)error_size;
  result[0] = 0;
  return 0;
}

static int equal(const hapgrid_model* model, const double* a, const double* b) {
  (void)model;
  return a[0] == b[0];
}

static void force(hapgrid_model* model, const double* x, const double* s, double* f) {
  (void)s;
  if (x[0] > 0.5 && model->crash) abort();
  while (x[0] > 0.5) pause();
  f[0] = 0.5;
  f[1] = f[2] = 0;
}

const hapgrid_model_table* hapgrid_model_plugin(void) {
  static const hapgrid_model_table table = {.interface_version = HAPGRID_MODEL_INTERFACE,
                                            .summary = "gets stuck",
                                            .create = create,
                                            .destroy = destroy,
                                            .info = info,
                                            .known_states = known_states,
                                            .convert = convert,
                                            .equal = equal,
                                            .force = force};
  return &table;
}
