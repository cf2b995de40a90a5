// play --selftest: whether this machine can hold a haptic loop.
#pragma once

#include "tools/play/options.hpp"

namespace hapgrid {

/// Runs the loop without a device, in turns with a bare loop of clock_nanosleep(), which measures
/// what cyclictest does, and prints both with a grade. @return an exit code
int run_selftest(const PlayOptions& options);

}  // namespace hapgrid
