#include "libcore/model/plugin.h"

const hapgrid_model_table* hapgrid_model_plugin(void) { return NULL; }
