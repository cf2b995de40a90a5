#!/bin/bash
# All rounds as one batch job: sbatch job.sh my.toml, in the directory of rounds.sh.
# When a node dies, Slurm puts the job into the queue again, and it goes on where it was.
#SBATCH --ntasks=4 --cpus-per-task=1 --requeue --output=job.out --open-mode=append
exec ./rounds.sh "$1" "$SLURM_NTASKS" srun --kill-on-bad-exit=0
