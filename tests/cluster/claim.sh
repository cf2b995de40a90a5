#!/bin/bash
# A step a round, whose tasks claim shards: in an allocation, and each step a job of its own.
source "$(dirname "$0")/../cli/lib.sh"
source "$here/slurm.sh"
cluster_start 3 2

reference
build PARTS=13 MODE=claim RUN="srun -n 6"
cmp work/hung-ball.grid reference
[[ ! -s make.err ]] || fail "$(cat make.err)"
# Each shard was made once.
same "conversions" "$(stats reference --get conversions)" \
  "$(stats work/hung-ball.grid --reports work/hung-ball.report --get reports.conversions)"

rm -rf work
in_allocation 6 PARTS=13 MODE=claim RUN=srun
cmp work/hung-ball.grid reference
[[ ! -s make.err ]] || fail "$(cat make.err)"
