#!/bin/bash
# A node dies in the middle and comes back later, for each way to hand out shards.
source "$(dirname "$0")/../../cli/lib.sh"
source "$here/../slurm.sh"
cluster_start 3 2
small=(grid.counts=[4,6,6] grid.spacing=0.15)  # few rounds: sbatch --wait looks every 10 s
slowed 50
reference

lose_a_node() {
  wait_for 60 "round 2 on node 2" generation 2 2
  node_kill 2
  wait_for 60 "end of node 2" eval '[[ $(sinfo -h -n n2 -o %T) == down* ]]'
  node_start 2
}
for how in srun claim array; do
  rm -rf work
  lose_a_node &
  case $how in
    srun) build PARTS=6 RUN='srun -n1' -j 6 ;;
    claim) build PARTS=12 MODE=claim RUN='srun -n 4' ;;  # 6 would wait for the node
    array) build PARTS=12 MODE=array ;;
  esac
  wait $! || fail "$how: the node: $(cat make.err make.out)"
  cmp work/hung-ball.grid reference
  grep -q 'hung-ball: generation 2: .* shards are missing, again' make.err || [[ $how == array ]] ||
    fail "$how: nothing was lost: $(cat make.err)"  # Slurm itself starts an array's elements again
  # Tasks that stay are where they were started: on the first nodes, if these are free again.
  wait_for 60 "idle nodes" eval '[[ $(sinfo -h -N -o %T | grep -cx idle) == 3 ]]'
done
