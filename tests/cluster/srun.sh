# Rounds on Slurm inside an allocation: one srun a round, one srun a part by make, and a batch job.
source "$(dirname "$0")/../cli/lib.sh"
source "$here/slurm.sh"
cluster_start 3 2
define 5
# srun says when a step has to wait until another one has left its processor.
said_nothing() { ! grep -vE '^srun: (Job [0-9]+ step creation|Step created)' err >said || fail "$(cat said)"; }

in_allocation 6 hapgrid rounds my.toml -- srun -n 6
cmp my.grid reference
said_nothing

in_allocation 6 make -s -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL=my.toml HAPGRID_BIN="$HAPGRID_BIN" \
  PARTS=6 RUN='srun -N1 -n1 --exclusive' -j 6
cmp work/my.grid reference
said_nothing

rm -r my.rounds my.grid
sbatch -Q "$HAPGRID_SOURCE/examples/cluster/job.sh" my.toml
evidence() { squeue; cat job.out; }
wait_for 60 "grid of the batch job" test -e my.grid
cmp my.grid reference
