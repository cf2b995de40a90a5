#!/bin/bash
# All rounds as one batch job: sbatch job.sh my.toml, where hapgrid is in the PATH.
# When a node dies, Slurm puts the job into the queue again, and it goes on where it was.
#SBATCH --ntasks=4 --cpus-per-task=1 --requeue --output=job.out --open-mode=append
exec hapgrid rounds "$@" -- srun --kill-on-bad-exit=0
