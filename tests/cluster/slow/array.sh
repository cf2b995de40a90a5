#!/bin/bash
# A round as a job array, whole and with elements that are lost.
source "$(dirname "$0")/../../cli/lib.sh"
source "$here/../slurm.sh"
cluster_start 3 2

small=(grid.counts=[4,6,6] grid.spacing=0.15)
reference
build PARTS=7 MODE=array LIMIT=5
cmp work/hung-ball.grid reference
[[ ! -s make.err ]] || fail "$(cat make.err)"
[[ -z $(squeue -h) ]] || fail "jobs are left: $(squeue)"

# Elements are cancelled in two rounds.
rm -rf work
slowed 50
reference
(
  for round in 1 2; do
    wait_for 60 "round $round" generation $round
    scancel --state=RUNNING --name="$(squeue -h -o %j | head -n 1)"
  done
) &
build PARTS=12 MODE=array RUN='sbatch --time=10'
wait $!
cmp work/hung-ball.grid reference
grep -q 'shards are missing, again in 1 s' make.err || fail "nothing was lost: $(cat make.err)"

# Interrupted, it takes its jobs with it.
rm -rf work
driver PARTS=12 MODE=array &
driver=$!
wait_for 60 "a job" eval '[[ $(squeue -h -t R) ]]'
kill -TERM "$(pgrep -P $driver -x make)"
wait $driver && fail 'it went on'
wait_for 20 "end of its jobs" eval '[[ -z $(squeue -h) ]]'
