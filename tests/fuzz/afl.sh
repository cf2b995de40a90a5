#!/bin/bash
# AFL++ on the filters as they are installed, SECONDS each (default: 600), one on each processor. `.ci/packages afl`
# installs it.
#
#   tests/fuzz/afl.sh [SECONDS [NAME...]]
#
# It builds them in build-afl with the undefined-behaviour sanitizer; memory is limited, as `ulimit -v` does it, so that
# one line of refusal is expected there, too. What a run found is where the next one begins (build-afl/out/NAME, with
# findings in crashes/ and hangs/). At the end there is a table of the last runs: minutes, executions, the share
# of the edges of the code that were reached, inputs that were kept, findings.
set -euo pipefail
seconds=${1:-600}
(($# == 0)) || shift
source=$(realpath "$(dirname "$0")/../..")
build=$source/build-afl
corpus=$source/tests/fuzz/corpus
# What runs on which corpus; @@ is the input's name. A file of positions that goes through the box of the shards there.
path=$corpus/texts/made-path-path
declare -A runs=(
  [seed]="texts seed @@"
  [expand]="shard expand -j 1 @@"
  [expand-complete]="shard expand --complete -j 1 @@"
  [merge]="shard merge @@"
  [verify]="shard verify -j 1 @@"
  [stats]="shard stats --format json @@"
  [stats-session]="session stats @@"
  [play]="shard play @@ --device path:$path"
  [play-replay]="session play $corpus/shard/made-stored --device replay:@@"
  [view]="streams view --png /dev/null --size 40x30 @@"
)
names=("$@")
((${#names[@]})) || mapfile -t names < <(printf '%s\n' "${!runs[@]}" | LC_ALL=C sort)

if [[ -n ${HAPGRID_AFL_ONE:-} ]]; then
  name=${names[0]}
  read -ra run <<<"${runs[$name]}"
  # AFL's own abort is no finding where a plug-in is loaded after the first input.
  export AFL_IGNORE_PROBLEMS=1 HAPGRID_MODEL_PATH=$build/models AFL_SKIP_CPUFREQ=1 AFL_NO_UI=1 AFL_NO_AFFINITY=1 \
    AFL_AUTORESUME=1 AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES=1 AFL_IGNORE_SEED_PROBLEMS=1 UBSAN_OPTIONS=abort_on_error=1:symbolize=0
  "$source/tests/fuzz/corpus.sh" "${run[0]}" "$build/out/$name.begin"
  # An input may take two seconds: a small shard can ask for some million points.
  nice -n 15 afl-fuzz -i "$build/out/$name.begin" -o "$build/out/$name" -V "$seconds" -t 2000 -m 1024 -- \
    "$build/bin/${run[1]}" "${run[@]:2}" >"$build/out/$name.log" 2>&1 || { tail -n 30 "$build/out/$name.log" >&2; exit 1; }
  exit
fi

for name in "${names[@]}"; do
  [[ -n ${runs[$name]:-} ]] || { echo "$name: one of ${!runs[*]} is needed" >&2; exit 2; }
done
command -v afl-fuzz >/dev/null || { echo "there is no afl-fuzz: .ci/packages afl" >&2; exit 1; }
(cd "$source" && cmake --preset afl >/dev/null && cmake --build --preset afl >/dev/null)
mkdir -p "$build/out"
code=0
printf '%s\n' "${names[@]}" | HAPGRID_AFL_ONE=1 xargs -I NAME -P "$(nproc)" "$0" "$seconds" NAME || code=$?

printf '|filter|minutes|executions|edges|inputs|crashes|hangs|\n|---|--:|--:|--:|--:|--:|--:|\n'
for name in "${names[@]}"; do
  awk -F ' *: *' -v name="$name" '{ s[$1] = $2 }
    END { printf "|`%s`|%.1f|%d|%s|%d|%d|%d|\n", name, s["run_time"] / 60, s["execs_done"],
      s["bitmap_cvg"], s["corpus_count"], s["saved_crashes"], s["saved_hangs"] }' "$build/out/$name/default/fuzzer_stats"
done
exit "$code"
