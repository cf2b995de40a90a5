#!/usr/bin/env bash
# What everything between two conversions costs on this machine, in seconds, for simulate.py.
#
#   tests/bench/scaling/costs.sh [BUILD] > costs.json         (default: build); two minutes at rest
#
# CPU time wherever nothing is waited for, so that other work on the machine does not count; medians.
# As root there are those of Slurm, too, from one of its own (tests/cluster/slurm.sh).
set -euo pipefail
HAPGRID_BUILD=$(realpath "${1:-build}")
# shellcheck source=../../cli/lib.sh
source "$(dirname "$0")/../../cli/lib.sh"
# shellcheck source=../../cluster/slurm.sh
source "$here/../../cluster/slurm.sh"
PATH=$HAPGRID_BUILD/bench:$PATH
TIMEFORMAT='%U %S'

cpu() { { time "$@" >/dev/null 2>&3; } 3>&2 2>&1 | awk '{ print $1 + $2 }'; }
wall() {
  local start=$EPOCHREALTIME
  "$@" >/dev/null
  awk "BEGIN { print $EPOCHREALTIME - $start }"
}
median() { sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
calc() { awk "BEGIN { printf \"%.4g\", ($*) }"; }
# put NAME SECONDS: nothing is faster than nothing, whatever the noise.
put() { awk -v name="$1" -v s="$2" 'BEGIN { printf "    \"%s\": %.3g,\n", name, (s > 0 ? s : 0) }' >>costs; }

# The rounds of a grid of 64 points a side: a request in expand and in merge, a chunk read and written
# again, a start; least squares over the rounds' reports.
n=64
seed "$ball" --set "grid.counts=[$n,$n,$n]" --set "grid.spacing=$(calc "1.95 / ($n - 1)")" \
  --set 'grid.origin=[-0.975,-0.975,-0.975]' -o grid
cp grid frontier.1
while (($(stats --get frontier grid))); do
  expand frontier.1 --report expand.report -o requests
  merge grid requests --frontier 'frontier.{}' --report merge.report -o next
  mv next grid
done
bench_growth grid 64 >growth
bench_conversions grid 2>/dev/null >own
/usr/bin/python3 - >fits <<'PY'
import json
import numpy as np
growth = np.loadtxt("growth")
def fit(name, columns):
    took = [json.loads(line)["cpu_seconds"] for line in open(name + ".report")]
    return np.linalg.lstsq(np.column_stack(columns), took, rcond=None)[0]
rounds, requests, chunks = np.ones(len(growth)), growth[:, 1], growth[:, 2]
request = fit("expand", [rounds, requests])[1] - float(open("own").read()) * 1e-9
print("request_write", request)
for name, value in zip(("merge_start", "request_merge", "chunk_merge"),
                       fit("merge", [rounds, requests, chunks])):
    print(name, value)
PY
while read -r name value; do put "$name" "$value"; done <fits

# Files: requests in 1 and in 500 shards for a merge; a file that is synced to the disk.
seed "$ball" -o seeds
expand --complete seeds -o complete
cp seeds grid
for _ in 1 2 3 4 5 6; do
  expand grid | merge grid - -o next
  mv next grid
done
expand grid -o one
for k in $(seq 500); do expand --part "$k/500" grid -o "many.$k"; done
few=$(for _ in 1 2 3 4 5; do cpu merge grid one -o next; done | median)
many=$(for _ in 1 2 3 4 5; do cpu merge grid many.* -o next; done | median)
put request_file "$(calc "($many - $few) / 499")"
few=$(for _ in 1 2 3 4 5; do wall merge grid one --frontier 'f.{}' --parts 1 -o next; done | median)
many=$(for _ in 1 2 3 4 5; do wall merge grid one --frontier 'f.{}' --parts 101 -o next; done | median)
put sync "$(calc "($many - $few) / 100")"
mkdir claims
put mkdir "$(calc "$(cpu bash -c 'mkdir claims/{1..2000}') / 2000")"

# Builds, in which next to nothing is computed: with few and with many shards, handed out as a list (for
# which the driver only waits), by make, and claimed by one task. `timed` stands for the workers.
cat >timed <<'END'
#!/bin/bash
TIMEFORMAT='%U %S'
{ time "$@" 2>&3; } 3>&2 2>>"$TIMED"
END
chmod +x timed
export TIMED=$PWD/seconds
small=("grid.counts=[12,6,6]" grid.spacing=0.15)
reference
rounds=$(stats --get generation reference)
# times_of PARTS OPTION...: CPU seconds a round of the build without the workers, and of these.
times_of() {
  local parts=$1 all
  shift
  rm -rf work "$TIMED"
  all=$(cpu build PARTS="$parts" RANGES=1 RUN=./timed "$@")
  awk -v all="$all" -v rounds="$rounds" \
    '{ s += $1 + $2 } END { print (all - s) / rounds, s / rounds }' "$TIMED"
}
read -r driver_few _ < <(times_of 1 MODE=list RUN='xargs -n 99 ./timed')
read -r driver_many _ < <(times_of 33 MODE=list RUN='xargs -n 99 ./timed')
part=$(calc "($driver_many - $driver_few) / 32")
put driver_round "$driver_few"
put driver_part "$part"  # with what its merge has to open
read -r _ worker_few < <(times_of 1 MODE=claim)
read -r _ worker_many < <(times_of 33 MODE=claim)
put claim "$(calc "($worker_many - $worker_few) / 32")"
read -r driver_few worker_few < <(times_of 1 MODE=make)
read -r driver_many worker_many < <(times_of 33 MODE=make)
put make_target "$(calc "($driver_many - $driver_few) / 32 - $part")"
put shard "$(calc "($worker_many - $worker_few) / 32")"

# Slurm: a step, many steps at a time, tasks of one step. Waited for, so a busy machine does count.
put poll 0.1  # how often tasks that stay look, a setting
if [[ $(id -u) == 0 ]] && command -v slurmctld >/dev/null; then
  cluster_start 8 8
  step() { srun -Q -N1 -n1 --exclusive true; }
  slurm_costs() {
    echo srun_step "$(for _ in 1 2 3 4 5 6 7; do wall step; done | median)"
    echo srun_serial "$(calc "$(wall bash -c 'seq 64 | xargs -P 16 -I K bash -c step') / 64")"
    few=$(for _ in 1 2 3; do wall srun -Q -n 8 true; done | median)
    many=$(for _ in 1 2 3; do wall srun -Q -n 64 true; done | median)
    echo srun_task "$(calc "($many - $few) / 56")"
  }
  export -f wall median calc step slurm_costs
  salloc -Q -n 64 bash -c slurm_costs >slurm
  while read -r name value; do put "$name" "$value"; done <slurm
else
  # Of another machine: examples/cluster/README.md.
  put srun_step 0.031
  put srun_serial 0.0167
  put srun_task 0.0025
fi
printf '{\n  "measured": "%s, %s, %s processors, load %s",\n  "seconds": {\n%s\n  }\n}\n' \
  "$(date -u +%F)" "$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -n 1)" "$(nproc)" \
  "$(cut -d ' ' -f 1 /proc/loadavg)" "$(sed '$s/,$//' costs)"
