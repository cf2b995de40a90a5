# A node dies in the middle of a round and comes back later. A round that failed is simply said again.
source "$(dirname "$0")/../../cli/lib.sh"
source "$here/../slurm.sh"
cluster_start 3 2
define 30
evidence() { cat err job.out; sinfo; squeue; }

lose_node_2() {
  wait_for 60 "round 1 on node 2" expanding 1 2
  node_kill 2
  wait_for 60 "end of node 2" eval '[[ $(sinfo -h -n n2 -o %T) == down* ]]'
  node_start 2
}

# Each round a job of its own, from a machine outside.
lose_node_2 &
hapgrid rounds my.toml -- srun -Q -n 6 >out 2>err && fail "nothing was lost"
wait $! || fail "the node"
[[ -e my.rounds/00001.grid && ! -e my.grid ]] || fail "$(ls my.rounds)"
wait_for 60 "three idle nodes" cluster_answers
hapgrid rounds my.toml -- srun -Q -n 6 >out 2>err || fail "$(cat err)"
cmp my.grid reference

# All rounds in one batch job, which Slurm starts again.
rm -r my.rounds my.grid
sbatch -Q -n 6 "$HAPGRID_SOURCE/examples/cluster/job.sh" my.toml
lose_node_2
wait_for 180 "grid" test -e my.grid
cmp my.grid reference
