#!/bin/bash
# Runs fuzz targets, SECONDS each, one on each processor; the preset `dev` builds them.
#
#   tests/fuzz/run.sh SECONDS [TARGET...]
#   tests/fuzz/run.sh --table        only prints the table of all runs so far
#
# What a run found is where the next one begins: new inputs are kept in build-dev/fuzz/found/TARGET. Findings go
# to build-dev/fuzz/findings, and a line for each run to build-dev/fuzz/log. At the end there is a table of the
# targets, summed over all runs since that log was begun (delete it to begin anew): CPU minutes, executions, edges of
# the code that were reached and libFuzzer's features of the last run, findings.
set -euo pipefail
seconds=${1:?seconds for each target}
shift
source=$(cd "$(dirname "$0")" && pwd)
build=${HAPGRID_FUZZ:-$source/../../build-dev}/fuzz

table() {
  printf '|target|CPU minutes|executions|edges|features|findings|\n|---|--:|--:|--:|--:|--:|\n'
  LC_ALL=C awk '!($1 in runs) { order[++n] = $1 }
    { runs[$1] += $2; cpu[$1] += $3; edges[$1] = $4; features[$1] = $5 }
    END { for (i = 1; i <= n; ++i) { t = order[i]; printf "%s %.2f %d %d %d\n", t, cpu[t] / 60, runs[t], edges[t], features[t] } }' \
    "$build/log" | LC_ALL=C sort | while read -r target cpu runs edges features; do
      findings=$(find "$build/findings" -type f -name "$target-*" | wc -l)
      printf '|`%s`|%s|%s|%s|%s|%s|\n' "$target" "$cpu" "$runs" "$edges" "$features" "$findings"
    done
}

if [[ $seconds == --table ]]; then
  table
  exit
fi
if [[ -z ${HAPGRID_FUZZ_ONE:-} ]]; then
  (($#)) || set -- $(cd "$source/corpus" && ls)
  mkdir -p "$build/findings"
  code=0
  printf '%s\n' "$@" | HAPGRID_FUZZ_ONE=1 xargs -n 1 -P "$(nproc)" "$0" "$seconds" || code=$?
  table
  exit "$code"
fi

target=$1
mkdir -p "$build/found/$target"
"$source/corpus.sh" "$target" "$build/begin/$target"
dictionary=()
[[ ! -e $source/$target.dict ]] || dictionary=("-dict=$source/$target.dict")
# A reader gets inputs of up to 64 KiB here, and 1 GiB of memory with all that the sanitizer needs.
code=0
TIMEFORMAT='%U %S'
{ time nice -n 15 "$build/fuzz_$target" "$build/found/$target" "$build/begin/$target" \
  "${dictionary[@]}" -max_total_time="$seconds" -max_len=65536 -rss_limit_mb=1024 -timeout=20 \
  -artifact_prefix="$build/findings/$target-" -print_final_stats=1 -verbosity=1 \
  >"$build/$target.log" 2>&1; } 2>"$build/$target.time" || code=$?
number() { sed -n "$1" "$build/$target.log" | tail -n 1 | grep . || echo 0; }
runs=$(number 's/^stat::number_of_executed_units: *//p')
edges=$(number 's/.* cov: \([0-9]*\) .*/\1/p')
features=$(number 's/.* ft: \([0-9]*\) .*/\1/p')
cpu=$(LC_ALL=C awk '{ printf "%.0f", $1 + $2 }' "$build/$target.time")
echo "$target $runs $cpu $edges $features $code" >>"$build/log"
((code == 0)) || { tail -n 30 "$build/$target.log" >&2; exit 1; }
