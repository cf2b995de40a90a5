#!/bin/bash
# The whole cluster is stopped in the middle; the driver is a job itself and goes down with its node, and
# Slurm starts it again. A cluster of its own: behind the arrays of restart.sh, Slurm lost the job's
# second start now and then, and started it a third time only minutes later.
source "$(dirname "$0")/../../cli/lib.sh"
source "$here/../slurm.sh"
cluster_start 3 2
small=(grid.counts=[4,6,6] grid.spacing=0.15)
slowed 50
reference

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
