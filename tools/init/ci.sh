#!/bin/sh
# What a CI server runs: everything anew. The exit code is not 0 when something is wrong, and the reports are in the
# output. HAPGRID=/path/to/hapgrid in the environment takes another hapgrid than the Makefile's.
set -eu
cd "$(dirname "$0")"
make clean
make
