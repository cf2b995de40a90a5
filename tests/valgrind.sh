#!/bin/bash
# The tests of the release build under valgrind, as root or with sudo for the packages:
#
#   tests/valgrind.sh [OPTIONS OF CTEST]
#
# Left out are clusters and emulated machines. operator new stays the program's, because some unit tests
# count its calls; it takes its memory from malloc, which valgrind watches.
set -euo pipefail
cd "$(dirname "$0")/.."
.ci/packages demo build check valgrind
cmake --preset check >/dev/null
cmake --build --preset check
logs=$PWD/build/valgrind
rm -rf "$logs"
mkdir "$logs"
export VALGRIND_OPTS="--leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite"
HAPGRID_WRAPPER="$(command -v valgrind) -q --error-exitcode=99 --fair-sched=yes --num-callers=20 --vgdb=no"
HAPGRID_WRAPPER+=" --soname-synonyms=somalloc=nouserintercepts --suppressions=$PWD/tests/valgrind.supp --log-file=$logs/%p"
export HAPGRID_WRAPPER
failed=0
ctest --preset check -E '^(qemu|cluster)/' --timeout 3600 -j "$(nproc)" "$@" || failed=1
# Some tests do not look at each process's exit code, so every log counts.
find "$logs" -type f -size +0 -exec head -n 40 {} +
[[ $failed == 0 && -z $(find "$logs" -type f -size +0) ]]
