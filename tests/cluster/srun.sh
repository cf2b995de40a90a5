#!/bin/bash
# make -j over srun, a step a shard, inside an allocation.
source "$(dirname "$0")/../cli/lib.sh"
source "$here/slurm.sh"
cluster_start 3 2

reference
in_allocation 6 PARTS=5 RUN="srun -N1 -n1 --exclusive" -j 6
cmp work/hung-ball.grid reference
[[ ! -s make.err ]] || fail "$(cat make.err)"
