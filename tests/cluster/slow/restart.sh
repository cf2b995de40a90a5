#!/bin/bash
# The whole cluster is stopped in the middle, the driver with it, and started again.
source "$(dirname "$0")/../../cli/lib.sh"
source "$here/../slurm.sh"
cluster_start 3 2
small=(grid.counts=[4,6,6] grid.spacing=0.15)  # few rounds: sbatch --wait looks every 10 s
slowed 50
reference

# The driver stays, on a machine of its own: it tries until the cluster is back.
off_and_on() {
  wait_for 60 "round 2" generation 2
  cluster_stop
  cluster_again
}
for how in srun claim array; do
  rm -rf work
  off_and_on &
  case $how in
    srun) build PARTS=6 TRIES=100 RUN='srun -n1' -j 6 ;;
    claim) build PARTS=12 TRIES=100 MODE=claim RUN='srun -n 6' ;;
    array) build PARTS=12 TRIES=100 MODE=array ;;
  esac
  wait $! || fail "$how: the cluster: $(cat make.err make.out)"
  cmp work/hung-ball.grid reference
done
