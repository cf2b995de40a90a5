#!/bin/bash
# What everything between two conversions costs on this machine, in CPU seconds, for simulate.py:
#
#   tests/bench/scaling/costs.sh [BUILD] > costs.tsv
#
# Slurm's costs are those of notes from a Slurm of one's own with 64 tasks: they are waited for, and do not
# depend on the build.
set -euo pipefail
build=$(realpath "${1:-build}")
ball=$(realpath "$(dirname "$0")/../../../examples/hung-ball/hung-ball.toml")
PATH=$build/bin:$build/bench:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# The rounds of a grid of 64 points a side, and those of one with next to no work in 1 and in 256 parts.
seed "$ball" --set 'grid.counts=[64,64,64]' --set 'grid.origin=[-0.975,-0.975,-0.975]' \
  --set grid.spacing=0.030952 -o grid
while (($(stats --get todo grid))); do
  expand grid --cost expand -o requests
  merge grid requests --cost merge -o next
  mv next grid
done
bench_conversions grid 2>/dev/null >own
seed "$ball" | expand --complete -o complete
seed "$ball" -o few
for _ in 1 2 3 4 5 6; do
  expand few | merge few - -o next
  mv next few
done
for k in {1..256}; do expand few --part "$k/256" -o many.$k --cost parts; done
expand few -o one
for _ in {1..9}; do
  merge few one -o next --cost merge.one
  merge few many.* -o next --cost merge.many
done
/usr/bin/python3 - <<'PY'
import json
import numpy as np

def lines(name):
    return [json.loads(line) for line in open(name)]

def cpu(name):
    return np.array([line["cpu_seconds"] for line in lines(name)])

conversions = np.array([line["conversions"] for line in lines("expand")])
rounds = np.ones(len(conversions))
# The grid that a merge copies has about a record for each 26 conversions so far.
records = np.cumsum(conversions) / 26
write = np.linalg.lstsq(np.column_stack([rounds, conversions]), cpu("expand"), rcond=None)[0]
merge = np.linalg.lstsq(np.column_stack([rounds, conversions, records]), cpu("merge"), rcond=None)[0]
file = (np.median(cpu("merge.many")) - np.median(cpu("merge.one"))) / 255
for name, seconds, what in (
        ("srun", 0.048, "until srun has started its first task"),
        ("srun_task", 0.0025, "each further task"),
        ("expand_start", np.median(cpu("parts")), "a part with next to no work"),
        ("request_write", write[1] - float(open("own").read()) * 1e-9, "a request in expand, beyond C"),
        ("merge_start", merge[0], "a merge with next to no work"),
        ("request_merge", merge[1], "a request in merge"),
        ("record_copy", merge[2], "a record of the grid in merge"),
        ("request_file", file, "a part's file in merge"),
        ("driver", 0.02, "two filters and the shell of a round")):
    print(f"{name}\t{max(seconds, 0):.3g}\t{what}")
PY
