/* A table that is complete but for one function, which HAPGRID_NULL_FUNCTION names (the build makes
 * one plug-in for each). */
#include "libcore/model/plugin.h"

static hapgrid_model* create(const hapgrid_parameter* list, size_t count, char* error,
                             size_t error_size) {
  (void)list, (void)count, (void)error, (void)error_size;
  return NULL;
}

static void destroy(hapgrid_model* model) { (void)model; }

static void info(const hapgrid_model* model, hapgrid_model_info* info) { (void)model, (void)info; }

static int known_states(hapgrid_model* model, const double* x, double* states, size_t capacity,
                        size_t* count, char* error, size_t error_size) {
  (void)model, (void)x, (void)states, (void)capacity, (void)count, (void)error, (void)error_size;
  return 1;
}

static int convert(hapgrid_model* model, const double* s, const double* x, const double* d,
                   double* result, char* error, size_t error_size) {
  (void)model, (void)s, (void)x, (void)d, (void)result, (void)error, (void)error_size;
  return 1;
}

static int equal(const hapgrid_model* model, const double* a, const double* b) {
  (void)model, (void)a, (void)b;
  return 1;
}

const hapgrid_model_table* hapgrid_model_plugin(void) {
  static hapgrid_model_table table;
  table.interface_version = HAPGRID_MODEL_INTERFACE;
  table.create = create;
  table.destroy = destroy;
  table.info = info;
  table.known_states = known_states;
  table.convert = convert;
  table.equal = equal;
  table.HAPGRID_NULL_FUNCTION = NULL;
  return &table;
}
