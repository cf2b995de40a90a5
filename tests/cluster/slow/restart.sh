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

# The driver is a job itself and goes down with its node; Slurm starts it again.
rm -rf work
cat >job <<END
#!/bin/bash
#SBATCH --requeue -n 6 --output=job.out --open-mode=append
echo started
exec make -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL="$ball" HAPGRID_BIN="$HAPGRID_BIN" \
  SET="${small[*]}" PAUSE=1 PARTS=12 MODE=claim RUN=srun
END
sbatch -Q job
wait_for 60 "round 2" generation 2
cluster_stop
cluster_again
wait_for 120 "grid" test -e work/hung-ball.grid
cmp work/hung-ball.grid reference
[[ $(grep -c '^started$' job.out) -eq 2 ]] || fail "$(cat job.out)"
[[ $(grep -c 'generation 0,' job.out) -eq 1 ]] || fail "it began again: $(cat job.out)"
