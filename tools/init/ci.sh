#!/bin/sh
# What a CI server runs: everything anew. The exit code is not 0 when something is wrong, and verify.xml is a report
# in the format of JUnit. HAPGRID=/path/to/hapgrid in the environment takes another hapgrid than the Makefile's.
set -eu
cd "$(dirname "$0")"
make clean
make @NAME@.grid junit
