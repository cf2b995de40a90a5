/* A plug-in of an interface that this hapgrid does not have: nothing but the version can be read.
 */
#include "libcore/model/plugin.h"

const hapgrid_model_table* hapgrid_model_plugin(void) {
  static const hapgrid_model_table table = {.interface_version = 999};
  return &table;
}
