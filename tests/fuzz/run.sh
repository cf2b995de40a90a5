#!/bin/bash
# Runs fuzz targets one after the other, SECONDS each, with what they found so far; built with
#
#   cmake --preset fuzz && cmake --build --preset fuzz
#   tests/fuzz/run.sh SECONDS [TARGET...]
#
# New inputs go to build-fuzz/fuzz/found/TARGET, findings to build-fuzz/fuzz/findings, and a line for
# each run to build-fuzz/fuzz/log: target, executions, CPU seconds, exit code.
set -euo pipefail
seconds=${1:?seconds for each target}
shift
source=$(cd "$(dirname "$0")" && pwd)
build=${HAPGRID_FUZZ:-$source/../../build-fuzz}/fuzz
(($#)) || set -- $(cd "$source/corpus" && ls)
mkdir -p "$build/findings"
failed=0
for target in "$@"; do
  mkdir -p "$build/found/$target"
  dictionary=()
  [[ ! -e $source/$target.dict ]] || dictionary=("-dict=$source/$target.dict")
  # A reader gets inputs of up to 64 KiB here, and 1 GiB of memory with all that the sanitizer needs.
  code=0
  TIMEFORMAT='%U %S'
  { time nice -n 15 "$build/fuzz_$target" "$build/found/$target" "$source/corpus/$target" \
    "${dictionary[@]}" -max_total_time="$seconds" -max_len=65536 -rss_limit_mb=1024 -timeout=20 \
    -artifact_prefix="$build/findings/$target-" -print_final_stats=1 -verbosity=1 \
    >"$build/$target.log" 2>&1; } 2>"$build/$target.time" || code=$?
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$target.log")
  cpu=$(awk '{ printf "%.0f", $1 + $2 }' "$build/$target.time")
  echo "$target ${runs:-?} $cpu $code" | tee -a "$build/log"
  ((code == 0)) || failed=1
done
exit "$failed"
