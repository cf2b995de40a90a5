/* A model that misbehaves as its parameters say, so that one plug-in serves many tests. It is also
 * the proof that a plug-in can be written in C11.
 *
 *   echo        create() fails and its message lists all parameters
 *   refuse      create() fails with this text; with "" it says nothing
 *   overrun     create() fails and leaves a message without a final NUL
 *   alone       create() takes 5 ms and fails when another thread creates a model meanwhile
 *   state_size, d_max, tolerance    what info() says (1, 1, 0)
 *   stored, hip_radius              likewise (0, 0)
 *   known       the number of states that known_states() claims (1): {0, 0, ..}, {1, 1, ..}, ...
 *   lose        known_states() and convert() fail with this text
 *   component   every component of convert()'s result (0): try nan
 *   crash       convert() aborts when it is not 0
 *   above       equal(a, b) is true where a is above b, too, when it is not 0
 *   unlike      equal() tells a state with this component from itself
 *
 * The build makes more plug-ins of it: each lacks the function HAPGRID_NULL_FUNCTION; and with
 * HAPGRID_STUCK it has a force, of half a newton along x until the HIP is beyond x = 0.5. There
 * force() never comes back, or it aborts with `crash`, and convert() does not.
 */
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>
#include <time.h>
#include <unistd.h>

#include "libcore/model/plugin.h"

struct hapgrid_model {
  hapgrid_model_info info;
  size_t known;
  double component;
  double unlike;
  int crash;
  int above;
  char lose[64];
};

static const hapgrid_parameter* find(const hapgrid_parameter* list, size_t count, const char* key) {
  for (size_t i = 0; i < count; ++i)
    if (strcmp(list[i].key, key) == 0) return &list[i];
  return NULL;
}

static double number(const hapgrid_parameter* list, size_t count, const char* key, double value) {
  const hapgrid_parameter* p = find(list, count, key);
  return p ? p->numbers[0] : value;
}

static void echo(const hapgrid_parameter* list, size_t count, char* error, size_t size) {
  size_t used = 0;
  for (size_t i = 0; i < count && used < size; ++i) {
    const hapgrid_parameter* p = &list[i];
    used += (size_t)snprintf(error + used, size - used, "%s type %d count %zu:", p->key,
                             (int)p->type, p->count);
    for (size_t k = 0; k < p->count && used < size; ++k) {
      if (p->texts && !p->numbers)
        used += (size_t)snprintf(error + used, size - used, " '%s'", p->texts[k]);
      else if (p->numbers && !p->texts)
        used += (size_t)snprintf(error + used, size - used, " %.17g", p->numbers[k]);
    }
    if (used < size) used += (size_t)snprintf(error + used, size - used, ";");
  }
}

/* Whether no other thread was here within 5 ms. */
static int alone(void) {
  static atomic_int inside;
  const int others = atomic_fetch_add(&inside, 1);
  thrd_sleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
  atomic_fetch_sub(&inside, 1);
  return others == 0;
}

static hapgrid_model* create(const hapgrid_parameter* list, size_t count, char* error,
                             size_t error_size) {
  const hapgrid_parameter* refuse = find(list, count, "refuse");
  if (find(list, count, "echo")) {
    echo(list, count, error, error_size);
    return NULL;
  }
  if (find(list, count, "overrun")) {
    memset(error, 'x', error_size);
    return NULL;
  }
  if (refuse) {
    snprintf(error, error_size, "%s", refuse->texts[0]);
    return NULL;
  }
  if (find(list, count, "alone") && !alone()) {
    snprintf(error, error_size, "another thread creates a model");
    return NULL;
  }
  hapgrid_model* model = calloc(1, sizeof *model);
  if (!model) return NULL;
  const hapgrid_parameter* lose = find(list, count, "lose");
  if (lose) snprintf(model->lose, sizeof model->lose, "%s", lose->texts[0]);
  model->known = (size_t)number(list, count, "known", 1);
  model->component = number(list, count, "component", 0);
  model->crash = number(list, count, "crash", 0) != 0;
  model->above = number(list, count, "above", 0) != 0;
  model->unlike = number(list, count, "unlike", -1);
  model->info.state_size = (uint32_t)number(list, count, "state_size", 1);
  model->info.d_max = number(list, count, "d_max", 1);
  model->info.tolerance = number(list, count, "tolerance", 0);
  model->info.stored = (uint32_t)number(list, count, "stored", 0);
  model->info.hip_radius = number(list, count, "hip_radius", 0);
  model->info.force_scale = 1;
  memset(model->info.tolerance_unit, 'u', sizeof model->info.tolerance_unit);
  return model;
}

static void destroy(hapgrid_model* model) { free(model); }

static void info(const hapgrid_model* model, hapgrid_model_info* info) { *info = model->info; }

static int known_states(hapgrid_model* model, const double* x, double* states, size_t capacity,
                        size_t* count, char* error, size_t error_size) {
  (void)x;
  if (model->lose[0]) {
    snprintf(error, error_size, "%s", model->lose);
    return 1;
  }
  const size_t n = model->info.state_size;
  for (size_t i = 0; i < model->known && i < capacity; ++i)
    for (size_t c = 0; c < n; ++c) states[i * n + c] = (double)i;
  *count = model->known;
  return 0;
}

static int convert(hapgrid_model* model, const double* s, const double* x, const double* d,
                   double* result, char* error, size_t error_size) {
  (void)s, (void)x, (void)d;
  if (model->lose[0]) {
    snprintf(error, error_size, "%s", model->lose);
    return -1;
  }
#ifndef HAPGRID_STUCK
  if (model->crash) abort();
#endif
  for (uint32_t c = 0; c < model->info.state_size; ++c) result[c] = model->component;
  return 0;
}

static int equal(const hapgrid_model* model, const double* a, const double* b) {
  for (uint32_t c = 0; c < model->info.state_size; ++c)
    if ((a[c] != b[c] && !(model->above && a[c] > b[c])) || a[c] == model->unlike) return 0;
  return 1;
}

#ifdef HAPGRID_STUCK
static void force(hapgrid_model* model, const double* x, const double* s, double* f) {
  (void)s;
  if (x[0] > 0.5 && model->crash) abort();
  while (x[0] > 0.5) pause();
  f[0] = 0.5;
  f[1] = f[2] = 0;
}
#endif

const hapgrid_model_table* hapgrid_model_plugin(void) {
  static hapgrid_model_table table = {.interface_version = HAPGRID_MODEL_INTERFACE,
                                      .summary = "does\nas it is told",
                                      .create = create,
                                      .destroy = destroy,
                                      .info = info,
                                      .known_states = known_states,
                                      .convert = convert,
                                      .equal = equal};
#ifdef HAPGRID_STUCK
  table.force = force;
#endif
#ifdef HAPGRID_NULL_FUNCTION
  table.HAPGRID_NULL_FUNCTION = NULL;
#endif
  return &table;
}
