# A force function that never comes back: the device is told to let go, and play ends by itself.
source "$(dirname "$0")/../lib.sh"
if sanitized; then skip "the stand-in for hidapi takes no sanitizer"; fi
mkdir models
cat >hang.cpp <<'CPP'
// The hung ball's place in a box of 1: one state, the force 1 N along x, but for ever beyond x = 0.8.
#include <unistd.h>

#include "libcore/model/plugin.hpp"

class Hang {
 public:
  static constexpr const char* kSummary = "hangs";
  explicit Hang(const hapgrid::Parameters&) {}
  void info(hapgrid_model_info& info) const {
    info.state_size = 1;
    info.d_max = 10;
    info.tolerance = 0.1;
    info.force_scale = 1;
  }
};
CPP
grep -n "HAPGRID_MODEL\|class \|concept" "$HAPGRID_SOURCE/libcore/model/plugin.hpp" >/dev/null
